//! Data files: CSV for reading into anything, JSON with the facts of the run.

use std::path::Path;

use serde_json::{Map, Value, json};

use super::error::ReportError;
use super::outcome::Figure;
use super::run::RunInfo;
use super::table::Table;

/// Writes a table as CSV with a line of column names.
pub fn write_csv(path: &Path, table: &Table) -> Result<(), ReportError> {
    let fail = |source| ReportError::Csv { path: path.to_owned(), source };
    let mut writer = csv::Writer::from_path(path).map_err(fail)?;
    writer.write_record(&table.columns).map_err(fail)?;
    for row in &table.rows {
        writer.write_record(row.iter().map(super::table::Value::raw)).map_err(fail)?;
    }
    writer.flush().map_err(|source| ReportError::io(path, source))
}

/// Facts of a run as JSON.
pub(super) fn run_json(info: &RunInfo) -> Map<String, Value> {
    let mut facts = Map::new();
    facts.insert("title".to_owned(), json!(info.title));
    facts.insert("command".to_owned(), json!(info.command));
    facts.insert("commit".to_owned(), json!(info.commit));
    facts.insert("seed".to_owned(), json!(info.seed));
    facts.insert("date".to_owned(), json!(info.date));
    facts.insert("machine".to_owned(), json!(info.machine));
    facts.insert("options".to_owned(), options(&info.options));
    facts
}

/// A data table of a figure with all that is needed to make it again.
pub(super) fn figure_json(info: &RunInfo, figure: &Figure, table: &Table) -> Value {
    let all: Vec<_> = info.options.iter().chain(&figure.options).cloned().collect();
    json!({
        "figure": figure.id, "title": figure.title, "table": table.name, "command": figure.command,
        "commit": info.commit, "seed": info.seed, "date": info.date, "machine": info.machine,
        "options": options(&all), "rows": table.json_rows(),
    })
}

fn options(options: &[(String, String)]) -> Value {
    Value::Object(options.iter().map(|(name, value)| (name.clone(), json!(value))).collect())
}

/// JSON as text for people and diffs, a row on a line.
pub(super) fn pretty(what: &str, value: &Value) -> Result<Vec<u8>, ReportError> {
    let fail = |source| ReportError::Json { what: what.to_owned(), source };
    let Value::Object(fields) = value else { return serde_json::to_vec_pretty(value).map_err(fail) };
    let mut lines = Vec::new();
    for (name, field) in fields {
        let name = serde_json::to_string(name).map_err(fail)?;
        let text = match field {
            Value::Array(rows) if !rows.is_empty() => {
                let rows: Result<Vec<_>, _> = rows.iter().map(serde_json::to_string).collect();
                format!("[\n    {}\n  ]", rows.map_err(fail)?.join(",\n    "))
            }
            other => serde_json::to_string(other).map_err(fail)?,
        };
        lines.push(format!("  {name}: {text}"));
    }
    Ok(format!("{{\n{}\n}}\n", lines.join(",\n")).into_bytes())
}
