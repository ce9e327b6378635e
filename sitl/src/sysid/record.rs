//! PWM and thrust over time, from a table with named columns. Every refusal names line and column.

use std::path::Path;

/// Motors.
pub const CHANNELS: usize = 4;
/// Fewer rows than this identify nothing.
const SHORTEST: usize = 400;
/// The shortest record, s.
const BRIEFEST: f64 = 4.0;

/// One flight.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// s, rising.
    pub time: Vec<f64>,
    /// What was sent to each motor, in the record's own unit.
    pub pwm: [Vec<f64>; CHANNELS],
    /// Total thrust, N.
    pub thrust: Vec<f64>,
    /// Battery, V, where the record has it.
    pub voltage: Option<Vec<f64>>,
}

/// Where the columns are.
struct Columns {
    time: usize,
    pwm: [usize; CHANNELS],
    thrust: usize,
    voltage: Option<usize>,
}

fn columns(headers: &csv::StringRecord) -> Result<Columns, String> {
    // A spreadsheet's export may begin with a byte-order mark.
    let names: Vec<&str> =
        headers.iter().map(|name| name.trim_start_matches('\u{feff}').trim()).collect();
    let at = |name: &str| names.iter().position(|n| *n == name);
    let pwm: Vec<usize> =
        (0..names.len()).filter(|i| names.get(*i).is_some_and(|n| n.starts_with("pwm_"))).collect();
    let found = pwm.len();
    Ok(Columns {
        time: at("t_s").ok_or("line 1: no column t_s")?,
        thrust: at("thrust_N").ok_or("line 1: no column thrust_N")?,
        pwm: pwm
            .try_into()
            .map_err(|_| format!("line 1: {found} columns pwm_…, {CHANNELS} wanted"))?,
        voltage: at("voltage_V"),
    })
}

/// Reads `t_s, pwm_…×4, thrust_N` and perhaps `voltage_V`; other columns are passed over.
///
/// # Errors
/// One line naming file, line and column.
pub fn read_csv(path: &Path) -> Result<Record, String> {
    let file = path.display().to_string();
    let input = std::fs::File::open(path).map_err(|e| format!("{file}: {e}"))?;
    parse_csv(std::io::BufReader::new(input), &file)
}

/// The same from anywhere; `file` stands in the errors.
///
/// # Errors
/// One line naming file, line and column.
pub fn parse_csv(input: impl std::io::Read, file: &str) -> Result<Record, String> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(input);
    let headers = reader.headers().map_err(|e| format!("{file}: {e}"))?.clone();
    let columns = columns(&headers).map_err(|e| format!("{file}: {e}"))?;
    let mut record = Record { voltage: columns.voltage.map(|_| Vec::new()), ..Record::default() };
    for row in reader.records() {
        let row = row.map_err(|e| format!("{file}: {}", e.to_string().replace('\n', " ")))?;
        let line = row.position().map_or(0, csv::Position::line);
        let value = |column: usize| -> Result<f64, String> {
            let name = headers.get(column).unwrap_or("");
            let text = row.get(column).unwrap_or("");
            let value = text.parse::<f64>().ok().filter(|x| x.is_finite());
            value
                .ok_or_else(|| format!("{file}: line {line}, column {name}: {text:?} is no number"))
        };
        let time = value(columns.time)?;
        if let Some(last) = record.time.last().filter(|last| time <= **last) {
            return Err(format!("{file}: line {line}, column t_s: {time} after {last}"));
        }
        record.time.push(time);
        for (channel, column) in record.pwm.iter_mut().zip(columns.pwm) {
            channel.push(value(column)?);
        }
        record.thrust.push(value(columns.thrust)?);
        if let (Some(voltage), Some(column)) = (&mut record.voltage, columns.voltage) {
            voltage.push(value(column)?);
        }
    }
    let names = columns.pwm.map(|at| headers.get(at).unwrap_or("").to_owned());
    record.check(&names).map_err(|e| format!("{file}: {e}"))?;
    Ok(record)
}

impl Record {
    /// s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        match (self.time.first(), self.time.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// Long enough, and every channel moves.
    ///
    /// # Errors
    /// One line naming the column.
    pub fn check(&self, names: &[String; CHANNELS]) -> Result<(), String> {
        let rows = self.time.len();
        if rows < SHORTEST || self.duration() < BRIEFEST {
            return Err(format!(
                "line {}: only {rows} rows over {:.1} s; {SHORTEST} rows and {BRIEFEST} s wanted",
                rows + 1,
                self.duration()
            ));
        }
        let largest_gap = self.time.windows(2).map(|w| w[1] - w[0]).enumerate();
        let (at, gap) =
            largest_gap.fold((0, 0.0), |max, (i, d)| if d > max.1 { (i, d) } else { max });
        if gap > 0.5 {
            return Err(format!("line {}, column t_s: a gap of {gap:.2} s", at + 3));
        }
        for (channel, name) in self.pwm.iter().zip(names) {
            if is_constant(channel) {
                return Err(format!("lines 2 to {}, column {name}: constant", rows + 1));
            }
        }
        if is_constant(&self.thrust) {
            return Err(format!("lines 2 to {}, column thrust_N: constant", rows + 1));
        }
        Ok(())
    }

    /// As a table that [`read_csv`] reads.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut text = String::from("t_s,pwm_1,pwm_2,pwm_3,pwm_4,thrust_N");
        text.push_str(if self.voltage.is_some() { ",voltage_V\n" } else { "\n" });
        for (i, time) in self.time.iter().enumerate() {
            text.push_str(&format!("{time:.4}"));
            let thrust = [&self.thrust];
            let columns = self.pwm.iter().chain(thrust).chain(self.voltage.as_ref());
            for column in columns {
                text.push_str(&format!(",{:.6}", column[i]));
            }
            text.push('\n');
        }
        text
    }
}

fn is_constant(values: &[f64]) -> bool {
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
    high - low <= 1e-9 * high.abs().max(1e-9)
}
