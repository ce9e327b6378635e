//! What somebody types into a running simulation: `fault KIND [VALUE]`, `clear KIND`.

use crate::flight::Flight;
use crate::scenario::{FAULTS, FaultSection};
use std::io::{BufRead, Write};
use std::sync::mpsc::{Receiver, channel};

/// Lines from the standard input.
#[derive(Debug)]
pub struct Console {
    lines: Receiver<String>,
}

impl Console {
    /// Listens from now on. Its thread ends with the program, or with its input.
    pub fn open() -> Self {
        let (sender, lines) = channel();
        std::thread::spawn(move || {
            for line in std::io::stdin().lock().lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    return;
                }
            }
        });
        Self { lines }
    }

    /// Does what was typed since the last call; `say` prints a line.
    pub fn serve<W: Write>(&self, flight: &mut Flight<W>, mut say: impl FnMut(&str)) {
        while let Ok(line) = self.lines.try_recv() {
            if !line.trim().is_empty() {
                say(&obey(&line, flight));
            }
        }
    }
}

fn obey<W: Write>(line: &str, flight: &mut Flight<W>) -> String {
    let words: Vec<_> = line.split_whitespace().collect();
    let environment = &mut flight.world.environment;
    let time = environment.now().0 as f64 * 1e-6;
    let known = |name: &str| FAULTS.iter().find(|rule| rule.name == name);
    match words.as_slice() {
        ["fault", name, rest @ ..] if rest.len() < 2 => {
            let Some(rule) = known(name) else {
                return format!("no fault {name}: see docs/scenarios.md");
            };
            let value = rest.first().map_or(Ok(0.0), |text| text.parse::<f64>());
            match value.ok().filter(|x| *x >= rule.range.0 && *x <= rule.range.1) {
                Some(value) => {
                    environment.faults.add(FaultSection::new(rule.kind, value, time));
                    format!("fault {name}: on")
                }
                None => format!("fault {name}: a value from {} to {}", rule.range.0, rule.range.1),
            }
        }
        ["clear", name] => match known(name) {
            Some(rule) => {
                environment.faults.clear(rule.kind);
                format!("fault {name}: off")
            }
            None => format!("no fault {name}: see docs/scenarios.md"),
        },
        _ => "commands: fault KIND [VALUE], clear KIND".into(),
    }
}
