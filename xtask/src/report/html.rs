//! The page: everything inline, no scripts, nothing from elsewhere. Written so that an XML parser can check it.

use std::fmt::Write as _;

use super::outcome::{Claim, Figure, Verdict};
use super::run::{RunInfo, Written};
use super::svg::escape;
use super::table::Table;

const STYLE: &str = include_str!("report.css");

/// The whole page.
pub(super) fn page(info: &RunInfo, figures: &[Written]) -> String {
    let title = escape(&info.title);
    let mut out = String::new();
    let _ = write!(
        out,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <meta name=\"color-scheme\" content=\"light dark\"/>\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<header>\n<h1>{title}</h1>\n"
    );
    for text in &info.summary {
        let _ = writeln!(out, "<p class=\"lead\">{}</p>", escape(text));
    }
    facts(&mut out, info);
    out.push_str("</header>\n");
    contents(&mut out, figures);
    verdicts(&mut out, figures);
    for written in figures {
        section(&mut out, written);
    }
    out.push_str("</main>\n</body>\n</html>\n");
    out
}

fn facts(out: &mut String, info: &RunInfo) {
    out.push_str("<dl class=\"facts\">\n");
    let mut fact = |name: &str, value: &str| {
        let _ = writeln!(out, "<div><dt>{}</dt><dd>{}</dd></div>", escape(name), escape(value));
    };
    fact("Command", &info.command);
    fact("Date", &info.date);
    fact("Commit", &info.commit);
    fact("Seed", &info.seed.to_string());
    for (name, value) in &info.options {
        fact(name, value);
    }
    for (name, value) in info.machine.facts() {
        fact(name, &value);
    }
    out.push_str("</dl>\n");
}

fn contents(out: &mut String, figures: &[Written]) {
    out.push_str("<nav aria-label=\"Contents\">\n<h2>Contents</h2>\n<ol>\n");
    if figures.iter().any(|written| !written.figure.claims.is_empty()) {
        out.push_str("<li><a href=\"#claims\">Claims of the paper</a></li>\n");
    }
    for Written { figure, .. } in figures {
        let (id, title) = (escape(&figure.id), escape(&figure.title));
        let _ = writeln!(out, "<li><a href=\"#{id}\">{title}</a></li>");
    }
    out.push_str("</ol>\n</nav>\n");
}

/// All claims of the run in one table.
fn verdicts(out: &mut String, figures: &[Written]) {
    let claims: Vec<(&Figure, &Claim)> =
        figures.iter().flat_map(|w| w.figure.claims.iter().map(move |claim| (&w.figure, claim))).collect();
    if claims.is_empty() {
        return;
    }
    out.push_str("<section id=\"claims\">\n<h2>Claims of the paper</h2>\n");
    let count = |verdict: Verdict| claims.iter().filter(|(_, claim)| claim.verdict == verdict).count();
    let tally = [Verdict::Held, Verdict::NotHeld, Verdict::NotTestable]
        .map(|verdict| format!("{} {}", count(verdict), verdict.words()));
    let _ = writeln!(out, "<p>{}.</p>", tally.join(", "));
    claim_table(out, claims.into_iter(), true);
    out.push_str("</section>\n");
}

fn claim_table<'a>(
    out: &mut String,
    claims: impl Iterator<Item = (&'a Figure, &'a Claim)>,
    with_figure: bool,
) {
    out.push_str("<div class=\"scroll\"><table class=\"claims\">\n<thead><tr>");
    if with_figure {
        out.push_str("<th>Figure</th>");
    }
    out.push_str(
        "<th>The paper\u{2019}s claim</th><th>What was found</th><th>Verdict</th></tr></thead>\n<tbody>\n",
    );
    for (figure, claim) in claims {
        out.push_str("<tr>");
        if with_figure {
            let id = escape(&figure.id);
            let _ = write!(out, "<td data-label=\"Figure\"><a href=\"#{id}\">{id}</a></td>");
        }
        let class = match claim.verdict {
            Verdict::Held => "held",
            Verdict::NotHeld => "not-held",
            Verdict::NotTestable => "not-testable",
        };
        let (paper, found) = (escape(&claim.paper), escape(&claim.found));
        let words = claim.verdict.words();
        let _ = writeln!(
            out,
            "<td data-label=\"Claim\">{paper}</td><td data-label=\"Found\">{found}</td>\
             <td data-label=\"Verdict\"><span class=\"verdict {class}\">{words}</span></td></tr>"
        );
    }
    out.push_str("</tbody>\n</table></div>\n");
}

fn section(out: &mut String, written: &Written) {
    let figure = &written.figure;
    let (id, title) = (escape(&figure.id), escape(&figure.title));
    let _ = writeln!(out, "<section id=\"{id}\">\n<h2>{title}</h2>");
    for paragraph in figure.caption.split("\n\n").filter(|text| !text.trim().is_empty()) {
        let _ = writeln!(out, "<p>{}</p>", escape(paragraph));
    }
    if !figure.command.is_empty() {
        let _ = writeln!(out, "<pre><code>{}</code></pre>", escape(&figure.command));
    }
    for (inline, names) in &written.pictures {
        let _ =
            writeln!(out, "<div class=\"picture\">\n{inline}</div>\n<p class=\"files\">{}</p>", links(names));
    }
    if !figure.claims.is_empty() {
        claim_table(out, figure.claims.iter().map(|claim| (figure, claim)), false);
    }
    for shown in &figure.tables {
        table(out, shown);
    }
    let mut remarks = Vec::new();
    if !written.data.is_empty() {
        remarks.push(format!("Data: {}", links(&written.data)));
    }
    if !figure.options.is_empty() {
        let options: Vec<_> =
            figure.options.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        remarks.push(format!("Settings: {}", escape(&options.join(", "))));
    }
    if let Some(seconds) = figure.seconds {
        remarks.push(format!("Made in {seconds:.1} s"));
    }
    for remark in remarks {
        let _ = writeln!(out, "<p class=\"files\">{remark}</p>");
    }
    out.push_str("</section>\n");
}

fn links(names: &[String]) -> String {
    let link = |name: &String| {
        let name = escape(name);
        format!("<a href=\"{name}\">{name}</a>")
    };
    names.iter().map(link).collect::<Vec<_>>().join(" \u{b7} ")
}

fn table(out: &mut String, table: &Table) {
    // A column is set flush right if it holds numbers and nothing else.
    let numeric: Vec<bool> = (0..table.columns.len())
        .map(|column| !table.rows.is_empty() && table.rows.iter().all(|row| row[column].is_number()))
        .collect();
    let class = |column: usize| if numeric[column] { " class=\"number\"" } else { "" };
    out.push_str("<div class=\"scroll\"><table>\n");
    if !table.name.is_empty() {
        let _ = writeln!(out, "<caption>{}</caption>", escape(&table.name));
    }
    out.push_str("<thead><tr>");
    for (idx, column) in table.columns.iter().enumerate() {
        let _ = write!(out, "<th{}>{}</th>", class(idx), escape(column));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for row in &table.rows {
        out.push_str("<tr>");
        for (idx, value) in row.iter().enumerate() {
            let _ = write!(out, "<td{}>{}</td>", class(idx), escape(&value.shown()));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody>\n</table></div>\n");
}
