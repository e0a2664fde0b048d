//! Nodes, elements, materials and sections of a deck.

use super::{DeckObjects, Fault, MESH};
use crate::format::error::at;
use crate::format::error::bail;
use crate::format::given::Cells;
use crate::format::spec::{BodySpec, Material, Nodes};
use crate::import::element_kind;
use std::collections::BTreeMap;
use stickslip_core::groups::Connected;
use stickslip_core::{ElementKind, Law, Plane, Update};
use stickslip_exchange::inp::deck::{Element, ElementType, Family, Form, Section};
use stickslip_exchange::mesh::CellKind;

/// Shear correction factor of a rectangular section (E. Reissner).
const SHEAR: f64 = 5.0 / 6.0;

/// Elements with equal keys form one body: their section, their element family, and a representative of their connected nodes.
type Part = (usize, Family, usize);

impl DeckObjects<'_> {
    /// Creates the mesh, its bodies and their materials.
    pub(super) fn bodies(&mut self, nlgeom: bool) -> Result<(), Fault> {
        let section_of = self.sections()?;
        self.material_of = section_of
            .iter()
            .map(|&section| self.deck.sections[section].material)
            .collect();
        let parts = self.parts(&section_of);
        let cells = self.solids(&parts, nlgeom)?;
        if cells.is_empty() {
            let place = self
                .deck
                .elements
                .first()
                .map(|e| e.place)
                .unwrap_or_default();
            bail!(
                place,
                "the deck has no continuum elements (CPE, CPS, CAX); at least one is needed"
            );
        }
        self.mesh(cells);
        self.beams(&section_of, nlgeom)
    }

    /// The section of each element.
    fn sections(&self) -> Result<Vec<usize>, Fault> {
        let mut section_of = vec![None; self.deck.elements.len()];
        for (k, section) in self.deck.sections.iter().enumerate() {
            let members = &self.deck.element_sets[section.set].members;
            members
                .iter()
                .for_each(|&element| section_of[element] = Some(k));
        }
        let both = section_of.into_iter().zip(&self.deck.elements);
        let known = |(section, element): (Option<usize>, &Element)| {
            section.ok_or_else(|| {
                let message = format!(
                    "element {} has no section; *SOLID SECTION or *BEAM SECTION must name its set",
                    element.label
                );
                Fault::new(element.place, message)
            })
        };
        both.map(known).collect()
    }

    /// The continuum elements of each body, in deck order.
    fn parts(&self, section_of: &[usize]) -> BTreeMap<Part, Vec<usize>> {
        let mut groups = Connected::new(self.deck.nodes.len());
        let solids = || {
            self.deck
                .elements
                .iter()
                .enumerate()
                .filter(|(_, e)| e.kind.family != Family::Beam)
        };
        solids().for_each(|(_, element)| groups.join_all(&element.nodes));
        let mut parts: BTreeMap<Part, Vec<usize>> = BTreeMap::new();
        for (k, element) in solids() {
            let part = (
                section_of[k],
                element.kind.family,
                groups.root(element.nodes[0]),
            );
            parts.entry(part).or_default().push(k);
        }
        parts
    }

    /// Bodies and materials of continua, and the cells of their mesh.
    fn solids(
        &mut self,
        parts: &BTreeMap<Part, Vec<usize>>,
        nlgeom: bool,
    ) -> Result<Vec<Cells>, Fault> {
        let deck = self.deck;
        let mut cells = Vec::new();
        for (&(section, family, _), elements) in parts {
            let section = &deck.sections[section];
            let material = self.continuum(section, family, nlgeom)?;
            let name = self.free.take(&deck.element_sets[section.set].name);
            self.origin
                .note(at!["bodies", self.spec.bodies.len()], section.place);
            for &element in elements {
                self.body_of[element] = Some(self.spec.bodies.len());
            }
            self.spec.bodies.push(BodySpec::Solid {
                id: name.clone(),
                mesh: format!("{MESH}.{name}"),
                material,
                regions: Vec::new(),
            });
            let mut kinds: BTreeMap<ElementType, Vec<usize>> = BTreeMap::new();
            for &element in elements {
                kinds
                    .entry(deck.elements[element].kind)
                    .or_default()
                    .push(element);
            }
            for (kind, elements) in kinds {
                let elements = elements.iter().map(|&k| &deck.elements[k]);
                let labels = |element: &Element| {
                    element
                        .nodes
                        .iter()
                        .map(|&n| deck.nodes[n].label as usize)
                        .collect()
                };
                cells.push(Cells {
                    part: name.clone(),
                    also: Vec::new(),
                    kind: kind_of(kind),
                    nodes: elements.clone().map(labels).collect(),
                });
                self.origin
                    .cells
                    .push(elements.map(|element| element.place).collect());
            }
        }
        Ok(cells)
    }

    fn mesh(&mut self, cells: Vec<Cells>) {
        let used = self
            .deck
            .nodes
            .iter()
            .zip(&self.used)
            .filter(|(_, used)| **used);
        self.origin.nodes = used.clone().map(|(node, _)| node.place).collect();
        self.spec.nodes.push(Nodes::Given {
            id: MESH.to_owned(),
            nodes: used
                .map(|(node, _)| (node.label as usize, node.at[0], node.at[1]))
                .collect(),
            elements: cells,
            sets: Vec::new(),
            sides: Vec::new(),
        });
    }

    /// The id of a continuum material, which is created if necessary.
    fn continuum(
        &mut self,
        section: &Section,
        family: Family,
        nlgeom: bool,
    ) -> Result<String, Fault> {
        let (name, young, poisson) = self.elastic(section)?;
        let thickness = match (section.form, family) {
            (Form::Solid { thickness }, Family::PlaneStrain | Family::PlaneStress) => thickness,
            _ => 1.0,
        };
        let plane = match family {
            Family::PlaneStress => Plane::Stress,
            Family::Axisymmetric => Plane::Axisymmetric,
            Family::PlaneStrain | Family::Beam | Family::Solid => Plane::Strain,
        };
        let update = if nlgeom { Update::Total } else { Update::Small };
        let wanted = |id: String| Material::Elastic {
            id,
            E: young,
            nu: poisson,
            law: Law::Svk,
            plane,
            thickness,
            update,
        };
        Ok(self.material(section, &name, wanted))
    }

    /// The id of a section's material, which is created if necessary.
    fn material(
        &mut self,
        section: &Section,
        name: &str,
        wanted: impl Fn(String) -> Material,
    ) -> String {
        if let Some(known) = self
            .spec
            .materials
            .iter()
            .find(|material| **material == wanted(material.id().to_owned()))
        {
            return known.id().to_owned();
        }
        let id = self.free.take(name);
        let place = self.deck.materials[section.material].elastic_place;
        self.origin
            .note(at!["materials", self.spec.materials.len()], place);
        self.spec.materials.push(wanted(id.clone()));
        id
    }

    /// Name, Young's modulus and Poisson's ratio of a section's material.
    fn elastic(&self, section: &Section) -> Result<(String, f64, f64), Fault> {
        let material = &self.deck.materials[section.material];
        match material.elastic {
            Some((young, poisson)) => Ok((material.name.clone(), young, poisson)),
            None => Err(Fault::new(
                material.place,
                format!("the material {} is not *ELASTIC", material.name),
            )),
        }
    }

    /// Beams: connected elements with the same section form one beam.
    fn beams(&mut self, section_of: &[usize], nlgeom: bool) -> Result<(), Fault> {
        let deck = self.deck;
        let mut chains: Vec<(usize, CellKind, Vec<usize>)> = Vec::new();
        for (element, &section) in deck.elements.iter().zip(section_of) {
            if element.kind.family != Family::Beam {
                continue;
            }
            let kind = element.kind.cell;
            match chains.last_mut() {
                Some((s, k, nodes))
                    if (*s, *k) == (section, kind) && nodes.last() == element.nodes.first() =>
                {
                    nodes.extend(&element.nodes[1..]);
                }
                _ => chains.push((section, kind, element.nodes.clone())),
            }
        }
        for (k, (section, kind, nodes)) in chains.into_iter().enumerate() {
            let section = &deck.sections[section];
            if k == 0 && !nlgeom {
                self.add_note(
                    section.place,
                    "beams use large rotations even without NLGEOM",
                );
            }
            self.beam(section, kind, &nodes)?;
        }
        Ok(())
    }

    fn beam(&mut self, section: &Section, kind: CellKind, nodes: &[usize]) -> Result<(), Fault> {
        let (name, young, poisson) = self.elastic(section)?;
        let Form::Rectangle { width, height } = section.form else {
            bail!(section.place, "a beam needs a *BEAM SECTION");
        };
        let area = width * height;
        let wanted = |id: String| Material::Section {
            id,
            EA: young * area,
            EI: young * area * height * height / 12.0,
            GA: Some(SHEAR * area * young / (2.0 * (1.0 + poisson))),
        };
        let material = self.material(section, &name, wanted);
        let id = self.free.take(&self.deck.element_sets[section.set].name);
        self.origin
            .note(at!["nodes", self.spec.nodes.len()], section.place);
        self.origin
            .note(at!["bodies", self.spec.bodies.len()], section.place);
        self.spec.nodes.push(Nodes::Chain {
            id: id.clone(),
            of: nodes.iter().map(|&node| self.node(node)).collect(),
            per_element: kind.nodes(),
        });
        self.spec.bodies.push(BodySpec::Beam {
            along: id.clone(),
            id,
            material,
        });
        Ok(())
    }
}

fn kind_of(kind: ElementType) -> ElementKind {
    match (kind.cell, kind.reduced) {
        (CellKind::Quad4, true) => ElementKind::Quad4Reduced,
        (CellKind::Quad8, true) => ElementKind::Quad8Reduced,
        (cell, _) => element_kind(cell).unwrap_or_default(),
    }
}
