//! JSON Schema as far as the description uses it; what it does not know it refuses.

use serde_json::{Map, Value, json};

/// Checks a value against a schema of a document; the first thing that does not fit.
pub fn check(document: &Value, schema: &Value, value: &Value) -> Result<(), String> {
    let Some(object) = schema.as_object() else { return Err(format!("a schema {schema}")) };
    let failed = |what: &str| Err(format!("{what}: {value} against {schema}"));
    for (key, rule) in object {
        match key.as_str() {
            "$ref" => {
                let pointer = rule.as_str().and_then(|text| text.strip_prefix('#')).ok_or("a reference elsewhere")?;
                let target = document.pointer(pointer).ok_or_else(|| format!("no {pointer}"))?;
                check(document, target, value)?;
            }
            "type" => {
                let kinds: Vec<&str> = match rule {
                    Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).collect(),
                    rule => rule.as_str().into_iter().collect(),
                };
                if !kinds.iter().any(|kind| is(kind, value)) {
                    return failed("type");
                }
            }
            "enum" if !rule.as_array().is_some_and(|values| values.contains(value)) => return failed("enum"),
            "oneOf" => {
                let fits =
                    rule.as_array().map(|all| all.iter().filter(|one| check(document, one, value).is_ok()).count());
                if fits != Some(1) {
                    return failed("oneOf");
                }
            }
            "minItems" if value.as_array().is_some_and(|items| (items.len() as u64) < rule.as_u64().unwrap_or(0)) => {
                return failed("minItems");
            }
            "maxItems" if value.as_array().is_some_and(|items| items.len() as u64 > rule.as_u64().unwrap_or(0)) => {
                return failed("maxItems");
            }
            "minimum" if value.is_number() && value.as_f64() < rule.as_f64() => return failed("minimum"),
            "items" => {
                for item in value.as_array().into_iter().flatten() {
                    check(document, rule, item)?;
                }
            }
            "required" => {
                let names = rule.as_array().into_iter().flatten().filter_map(Value::as_str);
                if let Some(lacks) = names.into_iter().find(|name| value.get(name).is_none()) {
                    return failed(&format!("no {lacks}"));
                }
            }
            "properties" => properties(document, rule, object, value)?,
            "additionalProperties"
            | "enum"
            | "minItems"
            | "maxItems"
            | "minimum"
            | "description"
            | "format"
            | "default"
            | "propertyNames" => {}
            other => return Err(format!("a keyword that is not checked: {other}")),
        }
    }
    Ok(())
}

/// Known properties fit; unknown ones are refused unless the schema says what they are: a description
/// names all there is.
fn properties(document: &Value, rule: &Value, schema: &Map<String, Value>, value: &Value) -> Result<(), String> {
    for (name, value) in value.as_object().into_iter().flatten() {
        match (rule.get(name), schema.get("additionalProperties")) {
            (Some(schema), _) => check(document, schema, value).map_err(|error| format!("{name}: {error}"))?,
            (None, Some(schema @ Value::Object(_))) => check(document, schema, value)?,
            (None, _) => return Err(format!("{name} is not described")),
        }
    }
    Ok(())
}

fn is(kind: &str, value: &Value) -> bool {
    match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        _ => false,
    }
}

#[test]
fn what_does_not_fit_is_found() {
    let document = json!({"components": {"schemas": {"Code": {"type": "string", "enum": ["a", "b"]}}}});
    let schema = json!({
        "type": "object",
        "required": ["code", "at"],
        "properties": {
            "code": {"$ref": "#/components/schemas/Code"},
            "at": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
            "more": {"type": ["integer", "null"], "minimum": 0},
        },
    });
    let fits = |value: Value| check(&document, &schema, &value);
    assert_eq!(fits(json!({"code": "a", "at": [1, 2.5], "more": null})), Ok(()));
    for bad in [
        json!([]),
        json!({"code": "a"}),
        json!({"code": "c", "at": [1, 2]}),
        json!({"code": "a", "at": [1]}),
        json!({"code": "a", "at": [1, 2, 3]}),
        json!({"code": "a", "at": [1, "2"]}),
        json!({"code": "a", "at": [1, 2], "more": 1.5}),
        json!({"code": "a", "at": [1, 2], "more": -1}),
        json!({"code": "a", "at": [1, 2], "other": 1}),
    ] {
        assert!(fits(bad.clone()).is_err(), "{bad}");
    }
    assert!(check(&document, &json!({"pattern": "x"}), &json!("x")).is_err(), "a keyword that nobody checks");
    assert!(check(&document, &json!({"$ref": "#/nowhere"}), &json!(1)).is_err());
}
