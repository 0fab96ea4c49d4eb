//! Structs that Rust and WGSL share lie the same way in memory, by naga's account.

use std::collections::BTreeSet;
use std::mem::offset_of;

use naga::TypeInner;
use relief_shaders::{frame, kernels, leb, pages, paper, planet, shadow};

/// A struct as Rust lays it out: name in WGSL, bytes, fields with their offsets.
struct Layout {
    name: &'static str,
    bytes: usize,
    fields: Vec<(&'static str, usize)>,
}

macro_rules! layout {
    ($name:literal, $rust:ty, $($field:ident),+) => {
        Layout {
            name: $name,
            bytes: size_of::<$rust>(),
            fields: vec![$((stringify!($field), offset_of!($rust, $field))),+],
        }
    };
}

impl Layout {
    /// An array of Rust whose items WGSL has as fields of their own.
    fn with(mut self, first: usize, names: &[&'static str]) -> Self {
        self.fields.extend(names.iter().enumerate().map(|(k, &name)| (name, first + 4 * k)));
        self
    }
}

fn shared() -> Vec<Layout> {
    use frame::uniform::UniformMesh;
    use shadow::paper::ShadowPaperMap;
    use shadow::{PointSun, ShadowWindow, SunlitPoint};
    vec![
        layout!(
            "Planet",
            planet::Planet,
            m,
            plane,
            root_level,
            table_bits,
            a_m,
            b_m,
            e2,
            step_m,
            min_m,
            max_m,
            unit_x_m,
            unit_y_m,
            seen_bits
        ),
        layout!(
            "View",
            planet::View,
            camera_s,
            camera_t,
            width,
            height,
            camera_h_hi_m,
            camera_h_lo_m,
            sin_lat,
            cos_lat,
            n0_m,
            w0,
            tan_x,
            tan_y,
            right,
            up,
            forward,
            sun
        ),
        layout!(
            "Style",
            frame::Style,
            overlay,
            shadow,
            sea,
            air,
            low_m,
            high_m,
            ambient,
            exaggeration_from_m,
            dark,
            bright,
            sun_colour,
            shade_colour,
            sky,
            ramp
        ),
        layout!("UniformMesh", UniformMesh, level, columns, rows, padding),
        layout!("Point", pages::Point, s, t, level, height_m),
        layout!("PointSun", PointSun, sun, level),
        layout!("SunlitPoint", SunlitPoint, s, t, height_m, visible),
        layout!("Corner", leb::Corner, s, t, height_m, level),
        layout!("Triangle", leb::Triangle, s, t, code),
        layout!(
            "LebParams",
            leb::Params,
            reach_m,
            curvature_m,
            turn_rad,
            range_m,
            slack_m,
            cos_corner,
            horizon,
            list_capacity,
            relief_capacity,
            horizon_distance,
            cone_sin,
            cone_cos
        )
        .with(offset_of!(leb::Params, squash), &["squash_xy", "squash_z", "squash_most"])
        .with(offset_of!(leb::Params, axis), &["axis_x", "axis_z"]),
        layout!("LebControl", leb::Control, count_in, count_out, relief, overflow, tested, culled, passes, horizon),
        layout!("LebArgs", leb::Args, groups, vertices, instances, first_vertex, first_instance),
        layout!("Patch", paper::Patch, s, t, code),
        layout!(
            "PaperControl",
            paper::Control,
            count_in,
            count_out,
            relief,
            overflow,
            tested,
            culled,
            passes,
            horizon,
            split,
            fillers
        ),
        layout!("ShadowWindow", ShadowWindow, sun, x, y, columns, rows, level, air),
        layout!("ShadowPaperMap", ShadowPaperMap, sun, spacing_m, m, q, reading),
    ]
}

/// What is wrong with a layout in a kernel; nothing where the kernel has no such struct.
fn faults(layout: &Layout, module: &naga::Module) -> Vec<String> {
    let named = module.types.iter().filter(|(_, t)| t.name.as_deref() == Some(layout.name));
    let mut faults = Vec::new();
    for (_, found) in named {
        let TypeInner::Struct { members, span } = &found.inner else {
            faults.push(format!("{} is no struct", layout.name));
            continue;
        };
        if *span as usize != layout.bytes {
            faults.push(format!("{}: {span} bytes, {} in Rust", layout.name, layout.bytes));
        }
        for (field, offset) in &layout.fields {
            match members.iter().find(|m| m.name.as_deref() == Some(*field)) {
                Some(member) if member.offset as usize == *offset => {}
                Some(member) => faults.push(format!("{}.{field}: at {}, {offset} in Rust", layout.name, member.offset)),
                None => faults.push(format!("{}.{field} is missing", layout.name)),
            }
        }
        // WGSL's own padding words need no twin each.
        let named = |name: &str| name.starts_with("padding") || layout.fields.iter().any(|(field, _)| *field == name);
        for name in members.iter().filter_map(|member| member.name.as_deref()).filter(|name| !named(name)) {
            faults.push(format!("{}.{name} has no twin", layout.name));
        }
    }
    faults
}

fn modules() -> Vec<(&'static str, naga::Module)> {
    kernels::ALL.iter().map(|&(name, source)| (name, naga::front::wgsl::parse_str(source).unwrap())).collect()
}

#[test]
fn rust_and_wgsl_agree() {
    let modules = modules();
    let mut met = BTreeSet::new();
    for layout in shared() {
        for (kernel, module) in &modules {
            let faults = faults(&layout, module);
            assert!(faults.is_empty(), "{kernel}: {faults:?}");
            met.extend(module.types.iter().any(|(_, t)| t.name.as_deref() == Some(layout.name)).then_some(layout.name));
        }
    }
    assert_eq!(met, shared().iter().map(|layout| layout.name).collect(), "each is in some kernel");
}

#[test]
fn a_difference_is_seen() {
    let modules = modules();
    let of = |name| &modules.iter().find(|(kernel, _)| *kernel == name).unwrap().1;
    let wrong = [
        layout!("View", planet::Planet, m),
        Layout { name: "View", bytes: size_of::<planet::View>(), fields: vec![("sun", 0)] },
        Layout { name: "View", bytes: size_of::<planet::View>() + 4, fields: vec![] },
    ];
    for layout in wrong {
        assert!(!faults(&layout, of("frame_draw")).is_empty());
    }
    let triangle = layout!("Triangle", leb::Triangle, s, t, code);
    let [s, t, code] = triangle.fields[..] else { panic!("three fields") };
    let with = |bytes, fields| faults(&Layout { name: "Triangle", bytes, fields }, of("leb_pass")).len();
    assert_eq!(with(triangle.bytes, vec![s, t, code]), 0);
    assert_eq!(with(triangle.bytes + 4, vec![s, t, code]), 1);
    assert_eq!(with(triangle.bytes, vec![s, ("t", code.1), ("code", t.1)]), 2);
    assert_eq!(with(triangle.bytes, vec![s, t]), 1);
    assert_eq!(with(triangle.bytes, vec![s, t, code, ("level", 12)]), 1);
}

/// `leb_args` reads the counts of both schemes by the names of its own struct.
#[test]
fn the_counts_of_both_schemes_lie_alike() {
    let shared = shared();
    let of = |name| &shared.iter().find(|layout| layout.name == name).unwrap().fields;
    assert!(of("PaperControl").starts_with(of("LebControl")));
    assert_eq!(leb::Args::DRAW_OFFSET as usize, offset_of!(leb::Args, vertices));
}
