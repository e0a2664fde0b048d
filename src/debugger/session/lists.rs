//! Commands on the session's lists: branches, breakpoints, watches.

use super::machine::{Reply, Session};
use super::refusal::Refusal;
use crate::history::breakpoints::{self, Breakpoint, Condition};
use crate::history::watches::Watch;
use crate::history::{branches, compare, verdicts};
use crate::record::command::To;
use stickslip_scene::shown;

impl Session {
    pub(super) fn branch(&mut self, to: &To) -> Result<Reply, Refusal> {
        let (count, current) = (self.tree.branches().len(), self.tree.current());
        let to = match to {
            To::Next => (current + 1) % count,
            To::Previous => (current + count - 1) % count,
            To::Named(name) => branches::find(&self.tree, name)?,
        };
        if count == 1 {
            return Err(Refusal::OneBranch);
        }
        self.tree.switch(to);
        self.cursor = self.frames().len() - 1;
        let name = branches::name(&self.tree, to);
        let verdict = verdicts::describe(&self.tree, &verdicts::verdict(&self.tree, to));
        Ok(Reply(format!("{name} ({verdict}): {}", self.told())))
    }

    pub(super) fn rename(&mut self, label: String) -> Result<Reply, Refusal> {
        let label = label.trim().to_owned();
        let number = |text: &str| {
            text.strip_prefix('b')
                .is_some_and(|n| n.parse::<u32>().is_ok())
        };
        let taken = self
            .tree
            .branches()
            .iter()
            .any(|branch| branch.label == label);
        if label.is_empty() || label.contains(shown::is_order) {
            return Err(Refusal::NoName);
        } else if taken {
            return Err(Refusal::TakenName(label));
        } else if number(&label) {
            return Err(Refusal::NumberName(label));
        }
        self.tree.rename(label, true);
        let name = branches::name(&self.tree, self.tree.current());
        Ok(Reply(format!("this branch is {name}")))
    }

    /// Compares the current branch with another one, by default with its parent.
    pub(super) fn side_by_side(&self, with: Option<&str>) -> Result<Reply, Refusal> {
        let current = self.tree.current();
        let with = match with {
            Some(name) => branches::find(&self.tree, name)?,
            None => self.tree.branches()[current]
                .parent
                .ok_or(Refusal::WhichBranch)?,
        };
        if with == current {
            return Err(Refusal::SameBranch);
        }
        let comparison = self
            .compare(current, with)
            .ok_or(Refusal::NothingToCompare)?;
        Ok(Reply(compare::describe(&self.tree, &comparison)))
    }

    pub(super) fn add_breakpoint(&mut self, condition: Condition) -> Reply {
        self.numbered += 1;
        let breakpoint = Breakpoint {
            id: self.numbered,
            condition,
            enabled: true,
        };
        let told = breakpoints::describe(self.model(), &breakpoint);
        self.breakpoints.push(breakpoint);
        Reply(format!("breakpoint {told}"))
    }

    pub(super) fn list_breakpoints(&self) -> String {
        let told = |b: &Breakpoint| breakpoints::describe(self.model(), b);
        let all: Vec<String> = self.breakpoints.iter().map(told).collect();
        match all.is_empty() {
            true => "there are no breakpoints; :break sets one".into(),
            false => format!("breakpoints {}", all.join(", ")),
        }
    }

    /// Finds a breakpoint by its number.
    pub(super) fn breakpoint(&mut self, id: u32) -> Result<&mut Breakpoint, Refusal> {
        let listed = self.list_breakpoints();
        let found = self.breakpoints.iter_mut().find(|b| b.id == id);
        found.ok_or(Refusal::NoBreakpoint { id, listed })
    }

    pub(super) fn delete(&mut self, id: Option<u32>) -> Result<Reply, Refusal> {
        match id {
            Some(id) => {
                self.breakpoint(id)?;
                self.breakpoints.retain(|b| b.id != id);
            }
            None => self.breakpoints.clear(),
        }
        Ok(Reply(self.list_breakpoints()))
    }

    pub(super) fn enable(&mut self, id: Option<u32>, on: bool) -> Result<Reply, Refusal> {
        match id {
            Some(id) => self.breakpoint(id)?.enabled = on,
            None => self.breakpoints.iter_mut().for_each(|b| b.enabled = on),
        }
        Ok(Reply(self.list_breakpoints()))
    }

    pub(super) fn watch(&mut self, watch: Watch) -> Result<Reply, Refusal> {
        if self.watches.iter().any(|other| other.name == watch.name) {
            return Err(Refusal::Watched(watch.name));
        }
        // The values of all watches are on the line of [`Session::aside`].
        let told = format!("watching {}", watch.name);
        self.watches.push(watch);
        Ok(Reply(told))
    }

    pub(super) fn unwatch(&mut self, name: &str) -> Result<Reply, Refusal> {
        let names: Vec<String> = self.watches.iter().map(|w| w.name.clone()).collect();
        if !names.iter().any(|other| other == name) {
            return Err(match names.is_empty() {
                true => Refusal::NoWatches,
                false => Refusal::NoWatch {
                    name: name.into(),
                    all: names.join(", "),
                },
            });
        }
        self.watches.retain(|watch| watch.name != name);
        Ok(Reply(format!("stopped watching {name}")))
    }
}
