//! Checks the frozen interface problem that a solver reports.

use super::fault::Fault;
use stickslip_core::{Friction, ReportedForm, ReportedProblem, counted};
use stickslip_exchange::attach::message::{Id, MatrixMessage, ProblemMessage};

/// Converts the problem, whose contacts have these ids.
///
/// # Errors [`Fault::Unfit`] if its parts do not match.
pub fn read_problem(problem: &ProblemMessage, ids: &[Id]) -> Result<ReportedProblem, Fault> {
    let unfit = |why: String| Fault::Unfit {
        message: "problem",
        why,
    };
    let count = problem.contacts.len();
    let place = |id: &Id| ids.iter().position(|known| known == id);
    let mut contacts = Vec::with_capacity(count);
    for id in &problem.contacts {
        match place(id) {
            Some(contact) if !contacts.contains(&contact) => contacts.push(contact),
            Some(_) => return Err(unfit(format!("contact {id} occurs twice"))),
            None => return Err(unfit(format!("contact {id} does not exist"))),
        }
    }
    if !(1..=2).contains(&problem.tangents) {
        return Err(unfit("tangents must be 1 or 2".into()));
    }
    let size = (1 + problem.tangents) * count;
    let cohesion = match problem.cohesion.as_slice() {
        [] => vec![0.0; count],
        all => all.to_vec(),
    };
    let or_zeros = |numbers: &[f64]| match numbers {
        [] => vec![0.0; size],
        all => all.to_vec(),
    };
    let (q, load) = (or_zeros(&problem.q), or_zeros(&problem.load));
    if problem.q.is_empty() && problem.load.is_empty() {
        return Err(unfit("it needs either q or load".into()));
    }
    if !problem.load.is_empty() && problem.kind == ReportedForm::Compliance {
        return Err(unfit("load is only allowed with a stiffness".into()));
    }
    let lengths = [
        ("q", q.len(), size),
        ("load", load.len(), size),
        ("mu", problem.mu.len(), count),
        ("cohesion", cohesion.len(), count),
    ];
    if let Some((name, found, wanted)) = lengths.iter().find(|(_, found, wanted)| found != wanted) {
        return Err(unfit(format!(
            "{name} has {found} numbers; expected {wanted}"
        )));
    }
    let matrix = match &problem.matrix {
        MatrixMessage::Rows(rows) => rows.clone(),
        MatrixMessage::Triplets {
            size: sent,
            triplets,
        } => {
            if *sent != size {
                return Err(unfit(format!(
                    "the matrix has size {sent}; expected {size}"
                )));
            }
            let mut rows = vec![vec![0.0; size]; size];
            for &(i, j, value) in triplets {
                let entry = rows.get_mut(i).and_then(|row| row.get_mut(j));
                *entry
                    .ok_or_else(|| unfit(format!("entry ({i}, {j}) is outside the matrix")))? +=
                    value;
            }
            rows
        }
    };
    if matrix.len() != size || matrix.iter().any(|row| row.len() != size) {
        return Err(unfit(format!(
            "the matrix must have {} of {}",
            counted(size, "row"),
            counted(size, "number")
        )));
    }
    let friction: Vec<Friction> = problem
        .mu
        .iter()
        .zip(&cohesion)
        .map(|(&mu, &cohesion)| Friction::from_coefficient(mu, cohesion))
        .collect();
    if friction
        .iter()
        .any(|f| !(0.0..90.0).contains(&f.angle) || !(0.0..f64::INFINITY).contains(&f.cohesion))
    {
        return Err(unfit(
            "mu and cohesion must be finite and not negative".into(),
        ));
    }
    Ok(ReportedProblem {
        contacts,
        tangents: problem.tangents,
        form: problem.kind,
        matrix,
        q,
        load,
        friction,
    })
}
