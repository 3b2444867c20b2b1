//! Tables: rows of typed values, for the page and for data files.

use serde::Serialize;
use serde_json::{Map, Value as Json};

use super::axis::grouped;
use super::error::ReportError;

/// A value in a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Words.
    Text(String),
    /// A whole number.
    Int(i64),
    /// A measured number; may be infinite or NaN, since divergence is data.
    Real(f64),
    /// Yes or no.
    Flag(bool),
    /// Nothing.
    Missing,
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Real(number)
    }
}

impl From<f32> for Value {
    fn from(number: f32) -> Self {
        Self::Real(f64::from(number))
    }
}

impl From<i64> for Value {
    fn from(number: i64) -> Self {
        Self::Int(number)
    }
}

impl From<u32> for Value {
    fn from(number: u32) -> Self {
        Self::Int(i64::from(number))
    }
}

impl From<usize> for Value {
    fn from(number: usize) -> Self {
        i64::try_from(number).map_or(Self::Real(number as f64), Self::Int)
    }
}

impl From<bool> for Value {
    fn from(flag: bool) -> Self {
        Self::Flag(flag)
    }
}

impl<T: Into<Value>> From<Option<T>> for Value {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Missing, Into::into)
    }
}

impl Value {
    fn from_json(value: Json) -> Self {
        match value {
            Json::Null => Self::Missing,
            Json::Bool(flag) => Self::Flag(flag),
            Json::Number(number) => {
                number.as_i64().map_or_else(|| number.as_f64().map_or(Self::Missing, Self::Real), Self::Int)
            }
            Json::String(text) => Self::Text(text),
            nested => Self::Text(nested.to_string()),
        }
    }

    /// For a reader: four digits, commas in thousands.
    pub fn shown(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Int(number) => grouped(*number as f64, 0),
            Self::Real(number) => four_digits(*number),
            Self::Flag(flag) => if *flag { "yes" } else { "no" }.to_owned(),
            Self::Missing => "\u{2013}".to_owned(),
        }
    }

    /// For CSV: full precision; infinite values and NaN by name, missing ones empty.
    pub fn raw(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Int(number) => number.to_string(),
            Self::Real(number) => number.to_string(),
            Self::Flag(flag) => flag.to_string(),
            Self::Missing => String::new(),
        }
    }

    /// For JSON, which has no infinite numbers: those and NaN become their names.
    pub fn json(&self) -> Json {
        match self {
            Self::Text(text) => Json::from(text.as_str()),
            Self::Int(number) => Json::from(*number),
            Self::Real(number) if number.is_finite() => Json::from(*number),
            Self::Real(_) => Json::from(self.raw()),
            Self::Flag(flag) => Json::from(*flag),
            Self::Missing => Json::Null,
        }
    }

    /// Whether it is set flush right.
    pub(super) fn is_number(&self) -> bool {
        matches!(self, Self::Int(_) | Self::Real(_) | Self::Missing)
    }
}

fn four_digits(number: f64) -> String {
    if number.is_nan() {
        return "not a number".to_owned();
    }
    if number.is_infinite() {
        return if number > 0.0 { "\u{221e}" } else { "\u{2212}\u{221e}" }.to_owned();
    }
    match number.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-3..1e7).contains(&size) => format!("{number:.2e}").replace('-', "\u{2212}"),
        size if size >= 1000.0 => grouped(number, 0),
        size if size >= 100.0 => grouped(number, 1),
        size if size >= 10.0 => grouped(number, 2),
        size if size >= 1.0 => grouped(number, 3),
        _ => grouped(number, 4),
    }
}

/// Named columns and rows of values. Units belong into the columns' names: `time_ms` in data, `Time \[ms\]` on the page.
#[derive(Clone, Debug)]
pub struct Table {
    /// Title on the page; for data, the end of the file's name (empty: the figure's id alone).
    pub name: String,
    /// Column names.
    pub columns: Vec<String>,
    /// Rows; shorter ones are filled up, longer ones cut.
    pub rows: Vec<Vec<Value>>,
}

impl Table {
    /// A table without rows.
    pub fn new(name: &str, columns: &[&str]) -> Self {
        let columns = columns.iter().map(|&column| column.to_owned()).collect();
        Self { name: name.to_owned(), columns, rows: Vec::new() }
    }

    /// With one more row.
    #[must_use]
    pub fn row(mut self, values: impl IntoIterator<Item = Value>) -> Self {
        self.push(values);
        self
    }

    /// Adds a row.
    pub fn push(&mut self, values: impl IntoIterator<Item = Value>) {
        let mut row: Vec<Value> = values.into_iter().take(self.columns.len()).collect();
        row.resize(self.columns.len(), Value::Missing);
        self.rows.push(row);
    }

    /// A table of structs: fields are columns, in their order. Infinite numbers and NaN become missing values here;
    /// where divergence must be told apart, use `row`.
    pub fn from_records<T: Serialize>(name: &str, records: &[T]) -> Result<Self, ReportError> {
        let mut table = Self::new(name, &[]);
        for (idx, record) in records.iter().enumerate() {
            let json = serde_json::to_value(record).map_err(|source| ReportError::Json {
                what: format!("record {idx} of table {name}"),
                source,
            })?;
            let Json::Object(fields) = json else {
                return Err(ReportError::Record { table: name.to_owned(), record: idx });
            };
            if idx == 0 {
                table.columns = fields.keys().cloned().collect();
            }
            let values: Vec<Value> = table
                .columns
                .iter()
                .map(|column| fields.get(column).cloned().map_or(Value::Missing, Value::from_json))
                .collect();
            table.rows.push(values);
        }
        Ok(table)
    }

    /// Rows as JSON objects.
    pub fn json_rows(&self) -> Vec<Json> {
        let object = |row: &Vec<Value>| {
            let fields = self.columns.iter().cloned().zip(row.iter().map(Value::json));
            Json::Object(fields.collect::<Map<_, _>>())
        };
        self.rows.iter().map(object).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_shown_with_four_digits() {
        for (number, text) in [
            (0.0, "0"),
            (1234567.0, "1,234,567"),
            (2.34567, "2.346"),
            (0.0123, "0.0123"),
            (-45.678, "\u{2212}45.68"),
            (1.5e-7, "1.50e\u{2212}7"),
            (f64::INFINITY, "\u{221e}"),
            (f64::NAN, "not a number"),
        ] {
            assert_eq!(Value::Real(number).shown(), text);
        }
        assert_eq!(Value::from(1_000_000usize).shown(), "1,000,000");
    }

    #[test]
    fn records_become_rows() {
        #[derive(Serialize)]
        struct Run {
            zeta: &'static str,
            alpha_ms: f64,
            colors: Option<u32>,
        }
        let runs = [
            Run { zeta: "a", alpha_ms: 0.5, colors: Some(4) },
            Run { zeta: "b", alpha_ms: f64::NAN, colors: None },
        ];
        let table = Table::from_records("", &runs).unwrap();
        assert_eq!(table.columns, ["zeta", "alpha_ms", "colors"]);
        assert_eq!(table.rows[0], [Value::from("a"), Value::Real(0.5), Value::Int(4)]);
        assert_eq!(table.rows[1][1..], [Value::Missing, Value::Missing]);
        assert!(Table::from_records("", &[1, 2]).is_err());
    }

    #[test]
    fn rows_have_the_width_of_the_table() {
        let table =
            Table::new("t", &["a", "b"]).row([1u32.into()]).row([1.0.into(), "x".into(), true.into()]);
        assert!(table.rows.iter().all(|row| row.len() == 2));
        assert_eq!(table.json_rows()[0].to_string(), r#"{"a":1,"b":null}"#);
        assert_eq!(Value::Real(f64::NEG_INFINITY).json(), Json::from("-inf"));
    }
}
