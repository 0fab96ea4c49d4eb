//! Structs of Rust and of WGSL are laid out alike.

use std::mem::offset_of;

use naga::TypeInner;
use relief_shaders::kernels;
use relief_shaders::leb::{Args, Control, Corner, Params, Triangle};

/// Size and offsets of a struct as WGSL lays it out.
fn layout(source: &str, name: &str) -> (usize, Vec<(String, usize)>) {
    let module = naga::front::wgsl::parse_str(source).unwrap();
    let (_, found) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)).unwrap();
    let TypeInner::Struct { members, span } = &found.inner else { panic!("{name} is no struct") };
    (*span as usize, members.iter().map(|m| (m.name.clone().unwrap(), m.offset as usize)).collect())
}

/// The first difference, if any.
fn compare(source: &str, name: &str, size: usize, fields: &[(&str, usize)]) -> Result<(), String> {
    let (span, members) = layout(source, name);
    let expected: Vec<(String, usize)> = fields.iter().map(|&(f, o)| (f.to_owned(), o)).collect();
    // WGSL's own padding words need no twin each.
    let members: Vec<_> = members.into_iter().filter(|(f, _)| !f.starts_with("padding")).collect();
    if (span, &members) == (size, &expected) {
        Ok(())
    } else {
        Err(format!("{name}: {span} {members:?}, not {size} {expected:?}"))
    }
}

macro_rules! fields {
    ($t:ty: $($f:ident),*) => { [$((stringify!($f), offset_of!($t, $f))),*] };
}

#[test]
fn layouts_agree() {
    let pass = kernels::LEB_PASS;
    compare(pass, "Triangle", size_of::<Triangle>(), &fields!(Triangle: s, t, code)).unwrap();
    compare(pass, "Corner", size_of::<Corner>(), &fields!(Corner: s, t, height_m, level)).unwrap();
    let control = fields!(Control: count_in, count_out, relief, overflow, tested, culled, passes, horizon);
    compare(pass, "LebControl", size_of::<Control>(), &control).unwrap();
    let squash = offset_of!(Params, squash);
    let axis = offset_of!(Params, axis);
    let mut params =
        fields!(Params: reach_m, curvature_m, turn_rad, range_m, slack_m, cos_corner, horizon, list_capacity).to_vec();
    params.extend([("squash_xy", squash), ("squash_z", squash + 4), ("squash_most", squash + 8)]);
    params.extend(fields!(Params: relief_capacity));
    params.extend([("axis_x", axis), ("axis_z", axis + 4)]);
    params.extend(fields!(Params: horizon_distance, cone_sin, cone_cos));
    compare(pass, "LebParams", size_of::<Params>(), &params).unwrap();
    let args = fields!(Args: groups, vertices, instances, first_vertex, first_instance);
    compare(kernels::LEB_ARGS, "LebArgs", size_of::<Args>(), &args).unwrap();
    assert_eq!(Args::DRAW_OFFSET as usize, offset_of!(Args, vertices));
}

#[test]
fn other_layouts_are_noticed() {
    let pass = kernels::LEB_PASS;
    assert!(compare(pass, "Triangle", 16, &fields!(Triangle: s, t, code)).is_err());
    assert!(compare(pass, "Triangle", 12, &[("s", 0), ("code", 4), ("t", 8)]).is_err());
    assert!(compare(pass, "Triangle", 12, &[("s", 0), ("t", 4)]).is_err());
}
