//! The planet that a path names.

use std::sync::Arc;

use axum::extract::{FromRef, FromRequestParts, Path};
use axum::http::request::Parts;
use relief_protocol::error::{Code, Fault};
use utoipa::IntoParams;
use utoipa::openapi::path::{Parameter, ParameterBuilder, ParameterIn};
use utoipa::openapi::schema::{ObjectBuilder, Type};
use utoipa::openapi::{Required, Schema};

use super::refused::Refused;
use crate::serve::hub::{Hub, Served};

/// `{name}` of a path.
pub struct At(pub Arc<Served>);

impl<S: Send + Sync> FromRequestParts<S> for At
where
    Arc<Hub>: FromRef<S>,
{
    type Rejection = Refused;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Refused> {
        let Path(name) = Path::<String>::from_request_parts(parts, state).await.map_err(|error| {
            Fault::new(Code::Malformed, error.to_string(), "a path is UTF-8, percent-encoded", "correct the path")
        })?;
        Ok(Self(Arc::<Hub>::from_ref(state).served(&name)?))
    }
}

impl IntoParams for At {
    fn into_params(_: impl Fn() -> Option<ParameterIn>) -> Vec<Parameter> {
        let name: Schema = ObjectBuilder::new().schema_type(Type::String).build().into();
        let parameter = ParameterBuilder::new()
            .name("name")
            .parameter_in(ParameterIn::Path)
            .required(Required::True)
            .description(Some("The planet: its file's stem"))
            .schema(Some(name));
        vec![parameter.build()]
    }
}
