//! The patch mesh: decoded, checked on its positions, and built again.

use relief_formats::file::Relief;
use relief_formats::file::section::MESH;
use relief_formats::mesh::{MeshFault, check_mesh, decode_section, patch_mesh};

use super::check::Check;
use super::finding::{Findings, Place};

/// Checks the mesh section.
pub(super) fn mesh(relief: &Relief, findings: &Findings) {
    let (grid, body) = (relief.grid(), relief.body());
    let mesh = match decode_section(relief.section_bytes(MESH).unwrap_or_default()) {
        Ok(mesh) => mesh,
        Err(error) => {
            findings.add(Check::MeshDecodes, Place::default(), error.to_string());
            return;
        }
    };
    if mesh.m != grid.m {
        findings.add(
            Check::MeshDecodes,
            Place::default(),
            format!("the mesh is for m = {}, the header for {}", mesh.m, grid.m),
        );
        return;
    }
    let faults = check_mesh(&mesh, body);
    for fault in &faults {
        let place = fault.place.map_or_else(Place::default, |at| Place::default().with(at, body.is_plane()));
        findings.add(check_of(fault.fault), place, format!("{} ({} in all)", fault.detail, fault.count));
    }
    if faults.is_empty() && mesh != patch_mesh(body, &grid, mesh.layout) {
        findings.add(Check::MeshEqual, Place::default(), "a sound mesh, but not that of this grid");
    }
}

fn check_of(fault: MeshFault) -> Check {
    match fault {
        MeshFault::Axis => Check::MeshAxis,
        MeshFault::IndexRange => Check::MeshIndices,
        MeshFault::OffBody => Check::MeshOnBody,
        MeshFault::Degenerate => Check::MeshArea,
        MeshFault::Orientation => Check::MeshOrientation,
        MeshFault::Open => Check::MeshClosed,
        MeshFault::NonManifold => Check::MeshManifold,
        MeshFault::Euler => Check::MeshEuler,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Two of these faults no section can have: indices are checked as they are decoded, and
    /// positions follow from the axes.
    #[test]
    fn every_fault_has_its_own_code() {
        use MeshFault::{Axis, Degenerate, Euler, IndexRange, NonManifold, OffBody, Open, Orientation};
        let faults = [Axis, IndexRange, OffBody, Degenerate, Orientation, Open, NonManifold, Euler];
        let codes: BTreeSet<_> = faults.iter().map(|&fault| check_of(fault).code()).collect();
        assert_eq!(codes.len(), faults.len());
        assert!(codes.iter().all(|code| code.starts_with("RLF-M")));
    }
}
