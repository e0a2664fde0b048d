//! Describes the contact law of a slave node's pair, with its numbers.

use stickslip_core::{Bond, Contact, ContactRecord};
use stickslip_scene::sig4;

/// The name of the law.
pub fn name(contact: &Contact) -> &'static str {
    match contact.bond {
        Bond::Hard => "hard",
        Bond::Tied { .. } => "tied",
        Bond::Giving([normal, tangential]) => match (normal > 0.0, tangential > 0.0) {
            (true, true) => "penalty, stick stiffness",
            (true, false) => "penalty",
            (false, _) => "stick stiffness",
        },
    }
}

/// The law's result in a minor iteration, one line per direction; empty for hard contact.
pub fn lines(contact: &Contact, record: &ContactRecord) -> Vec<String> {
    let [normal, tangential] = contact.bond.give();
    let mut lines = Vec::new();
    if contact.bond.is_tied() {
        lines.push(format!(
            "tied: F_n {}, F_t {} (not limited)",
            sig4(record.f_n),
            sig4(record.f_t)
        ));
    }
    if normal > 0.0 {
        let (give, inside) = (sig4(normal), sig4(normal * record.f_n));
        lines.push(format!("penalty: penetration c F_n = {inside}, c = {give}"));
    }
    if tangential > 0.0 {
        let (give, slip) = (sig4(tangential), sig4(tangential * record.f_t));
        lines.push(format!("elastic slip c F_t = {slip}, c = {give}"));
    }
    lines
}
