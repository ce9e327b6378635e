//! Which functions of a linked image can the flight task reach? A walk over its direct branches, in machine code.

use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

/// Where every panic ends.
const PANIC: &str = "rust_begin_unwind";

struct Function {
    name: String,
    calls: BTreeSet<u64>,
    /// Calls through a register: where to is not in the code.
    is_indirect: bool,
}

/// The functions of an image by address.
pub struct Code(BTreeMap<u64, Function>);

/// What the walk from a function found.
pub struct Reached {
    /// Functions.
    pub count: usize,
    /// From the start to a panic, if there is a way.
    pub panic: Option<Vec<String>>,
    /// Functions that call through a register.
    pub indirect: Vec<String>,
}

/// The target of a branch with link or of a wide branch at `pc`.
fn wide_branch(pc: u64, first: u16, second: u16) -> Option<u64> {
    let (first, second) = (u64::from(first), u64::from(second));
    if first & 0xF800 != 0xF000 || second & 0x8000 == 0 {
        return None;
    }
    let sign = first >> 10 & 1;
    let (j1, j2) = (second >> 13 & 1, second >> 11 & 1);
    let low = (second & 0x7FF) << 1;
    let is_conditional = second & 0x5000 == 0;
    let (offset, bits) = if is_conditional {
        // Of these encodings the conditions from 14 on are other instructions.
        if first >> 6 & 0xF >= 14 {
            return None;
        }
        (sign << 20 | j2 << 19 | j1 << 18 | (first & 0x3F) << 12 | low, 21)
    } else {
        let (i1, i2) = (1 ^ j1 ^ sign, 1 ^ j2 ^ sign);
        (sign << 24 | i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | low, 25)
    };
    let signed = ((offset << (64 - bits)) as i64) >> (64 - bits);
    Some(pc.wrapping_add(4).wrapping_add(signed as u64))
}

/// The target of a narrow branch.
fn narrow_branch(pc: u64, half: u16) -> Option<u64> {
    let extend = |value: u16, bits: u32| {
        let shift = 64 - bits;
        ((u64::from(value) << shift) as i64 >> shift) as u64
    };
    let offset = match half >> 11 {
        0b11100 => extend((half & 0x7FF) << 1, 12),
        0b11010 | 0b11011 if half >> 8 & 0xF < 14 => extend((half & 0xFF) << 1, 9),
        _ => return None,
    };
    Some(pc.wrapping_add(4).wrapping_add(offset))
}

impl Code {
    /// Reads an image.
    pub fn read(path: &Path) -> Result<Self, String> {
        let wrong = |e: String| format!("{}: {e}", path.display());
        let bytes = std::fs::read(path).map_err(|e| wrong(e.to_string()))?;
        let file = object::File::parse(&*bytes).map_err(|e| wrong(e.to_string()))?;
        // Mapping symbols say where code ends and tables begin.
        let mut marks = BTreeMap::new();
        let mut functions = BTreeMap::new();
        for symbol in file.symbols() {
            let Ok(name) = symbol.name() else { continue };
            match name.get(..2) {
                Some("$t") => drop(marks.insert(symbol.address(), true)),
                Some("$d") => drop(marks.insert(symbol.address(), false)),
                _ if symbol.kind() == SymbolKind::Text && symbol.size() > 0 => {
                    functions.insert(symbol.address() & !1, (name.to_owned(), symbol.size()));
                }
                _ => {}
            }
        }
        let mut code = BTreeMap::new();
        let sections: Vec<_> = file.sections().collect();
        for (&start, (name, size)) in &functions {
            let holds =
                |s: &&object::Section| (s.address()..s.address() + s.size()).contains(&start);
            let Some(section) = sections.iter().find(holds) else { continue };
            let data = section.data_range(start, *size).map_err(|e| wrong(e.to_string()))?;
            let data = data.ok_or_else(|| wrong(format!("{name} has no code")))?;
            let is_code = |at: u64| marks.range(..=at).next_back().is_none_or(|(_, code)| *code);
            code.insert(start, decode(name, start, data, is_code));
        }
        if code.is_empty() { Err(wrong("no functions".into())) } else { Ok(Self(code)) }
    }

    fn holding(&self, address: u64) -> Option<u64> {
        self.0.range(..=address).next_back().map(|(start, _)| *start)
    }

    /// Everything that the function of this name reaches.
    pub fn from(&self, root: &str) -> Result<Reached, String> {
        let start = self.0.iter().find(|(_, f)| f.name == root).map(|(start, _)| *start);
        let start = start.ok_or_else(|| format!("no function {root} in the image"))?;
        let mut came_from: HashMap<u64, u64> = HashMap::new();
        let mut waiting = vec![start];
        let mut seen = BTreeSet::from([start]);
        let mut panic = None;
        let mut indirect = Vec::new();
        while let Some(at) = waiting.pop() {
            let Some(function) = self.0.get(&at) else { continue };
            if function.name.contains(PANIC) {
                panic = Some(at);
                continue;
            }
            if function.is_indirect {
                indirect.push(readable(&function.name));
            }
            for target in function.calls.iter().filter_map(|call| self.holding(*call)) {
                if seen.insert(target) {
                    came_from.insert(target, at);
                    waiting.push(target);
                }
            }
        }
        let way = |mut at: u64| {
            let mut names = Vec::new();
            loop {
                names.extend(self.0.get(&at).map(|f| readable(&f.name)));
                match came_from.get(&at) {
                    Some(before) => at = *before,
                    None => break,
                }
            }
            names.reverse();
            names
        };
        Ok(Reached { count: seen.len(), panic: panic.map(way), indirect })
    }
}

fn decode(name: &str, start: u64, data: &[u8], is_code: impl Fn(u64) -> bool) -> Function {
    let halves: Vec<u16> =
        data.as_chunks::<2>().0.iter().map(|bytes| u16::from_le_bytes(*bytes)).collect();
    let mut function =
        Function { name: name.to_owned(), calls: BTreeSet::new(), is_indirect: false };
    let mut at = 0;
    while let Some(&first) = halves.get(at) {
        let pc = start + 2 * at as u64;
        let is_wide = first >> 11 >= 0b11101;
        at += if is_wide { 2 } else { 1 };
        if !is_code(pc) {
            continue;
        }
        let target = match halves.get(at - 1) {
            Some(&second) if is_wide => wide_branch(pc, first, second),
            _ => narrow_branch(pc, first),
        };
        // BLX by register, and BX by any but the link register, which returns.
        let by_register = first & 0xFF80 == 0x4780;
        let jumps = first & 0xFF80 == 0x4700 && first >> 3 & 0xF != 14;
        function.is_indirect |= by_register || jumps;
        let inside = start..start + data.len() as u64;
        function.calls.extend(target.filter(|target| !inside.contains(target)));
    }
    function
}

fn readable(name: &str) -> String {
    format!("{:#}", rustc_demangle::demangle(name))
}
