//! The doctor: well where all is well, and every known fault found by the check that is there for it.

use density_lab::doctor::{CHECKS, FAULTS, Finding, Subjects, examine};
use std::collections::BTreeSet;

#[test]
fn a_healthy_laboratory_is_found_well() {
    let examination = examine(1, 1, None);
    let alarms: Vec<(&str, &Finding)> = CHECKS
        .iter()
        .map(|check| check.name)
        .zip(&examination.findings[0])
        .filter(|(_, finding)| finding.is_alarm())
        .collect();
    assert!(alarms.is_empty(), "{alarms:?}");
    assert!(!examination.is_ill());
}

#[test]
fn every_fault_is_found_by_its_check() {
    assert!(FAULTS.len() >= 20);
    let names: BTreeSet<&str> = FAULTS.iter().map(|fault| fault.name).collect();
    assert_eq!(names.len(), FAULTS.len(), "names are distinct");
    let missed: Vec<(&str, String)> = FAULTS
        .iter()
        .filter_map(|fault| {
            let check = CHECKS
                .iter()
                .find(|check| check.name == fault.caught_by)
                .unwrap_or_else(|| panic!("{}: no check {}", fault.name, fault.caught_by));
            let mut subjects = Subjects::healthy();
            (fault.plant)(&mut subjects);
            let finding = (check.run)(&subjects, 1);
            (!finding.is_alarm()).then_some((fault.name, finding.detail))
        })
        .collect();
    assert!(missed.is_empty(), "{missed:?}");
}
