//! `relief-bake`: the command line.

fn main() {}
