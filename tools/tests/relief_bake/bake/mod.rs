//! `relief-bake bake`: right heights from any source, the same bytes in any order, clear refusals.

mod deviations;
mod hard_cases;
mod heights;
mod refused;
mod resumed;
