//! What the shrink factor s and the conflict rule of Algorithm 2 do: why the defaults are s = 2.5 and hashed priorities.
//!
//! `fig3-ablation.csv`, a row for each graph and setting: `family`, `vertices`, `min_degree`, `max_degree`, `shrink` (`inf`:
//! first fit in rounds), `is_min_degree` (s follows the graph's minimum degree, as the paper recommends), `rule` (`hash`,
//! `index` or `none`), `runs`, `colors` (median), `colors_min`, `colors_max`, `rounds`, `visits_per_vertex`, `time_ms`
//! (medians), `stragglers` (most vertices colored one by one after the bound on rounds).

use vivace_coloring::{Algorithm, ConflictRule, Vivace};

use super::families::{Families, Family, Model};
use super::measure::{Effort, Measured, Method, Run, measure};
use super::{Context, FigureError};
use crate::report::{Axis, Chart, Panel, Scale, Series, Table, Value};

/// Shrink factors that are compared.
pub const SHRINKS: [f32; 6] = [1.5, 2.0, 2.5, 3.0, 4.0, 6.0];
/// A palette of one color, fed as needed: first fit.
const INFINITE: f32 = 65_536.0;

/// A setting and its runs.
pub struct Setting {
    /// The settings but for the seed.
    pub vivace: Vivace,
    /// Whether s is the graph's minimum degree, within the bounds that [`Vivace::as_printed`] sets.
    pub is_min_degree: bool,
    /// The runs.
    pub measured: Measured,
}

/// All settings on one graph.
pub struct Ablation {
    /// The graph's family.
    pub family: Family,
    /// Its size.
    pub n_vertices: usize,
    /// Its smallest degree.
    pub min_degree: u32,
    /// Its largest degree.
    pub max_degree: u32,
    /// The settings.
    pub settings: Vec<Setting>,
}

impl Setting {
    /// The median of a quantity.
    pub fn median(&self, of: impl Fn(&Run) -> f64) -> f64 {
        self.measured.median(of)
    }

    /// The median number of colors.
    pub fn colors(&self) -> f64 {
        self.median(|run| f64::from(run.colors))
    }

    /// The median number of rounds.
    pub fn rounds(&self) -> f64 {
        self.median(|run| f64::from(run.rounds))
    }

    fn stragglers(&self) -> u32 {
        self.measured.runs.iter().map(|run| run.stragglers).max().unwrap_or(0)
    }

    fn shrink(&self) -> Value {
        if self.vivace.shrink >= INFINITE { Value::Real(f64::INFINITY) } else { self.vivace.shrink.into() }
    }
}

impl Ablation {
    /// The runs at a factor of [`SHRINKS`] under a rule.
    pub fn at(&self, shrink: f32, rule: ConflictRule) -> Option<&Setting> {
        let is_it = |s: &&Setting| {
            !s.is_min_degree && s.vivace.shrink.to_bits() == shrink.to_bits() && s.vivace.conflict == rule
        };
        self.settings.iter().find(is_it)
    }

    /// What the chart shows.
    fn curves(&self) -> impl Iterator<Item = &Setting> {
        let is_shown = |s: &&Setting| !s.is_min_degree && SHRINKS.contains(&s.vivace.shrink);
        self.settings.iter().filter(is_shown).filter(|s| s.vivace.conflict != ConflictRule::None)
    }

    /// The runs at s = minimum degree.
    pub fn at_min_degree(&self, rule: ConflictRule) -> Option<&Setting> {
        self.settings.iter().find(|s| s.is_min_degree && s.vivace.conflict == rule)
    }
}

fn rule_name(rule: ConflictRule) -> &'static str {
    match rule {
        ConflictRule::HighestHash => "hash",
        ConflictRule::HighestIndex => "index",
        ConflictRule::None => "none",
    }
}

/// Runs all settings on a graph, in turns.
///
/// # Errors
/// A coloring that is not proper.
pub fn measure_on(context: &Context<'_>, family: Family, model: &Model) -> Result<Ablation, FigureError> {
    let graph = &model.graph;
    let min_degree = Vivace::as_printed(graph.min_degree(), 0).shrink;
    let mut wanted = Vec::new();
    for conflict in [ConflictRule::HighestHash, ConflictRule::HighestIndex] {
        for (shrink, is_min_degree) in
            SHRINKS.iter().map(|&s| (s, false)).chain([(INFINITE, false), (min_degree, true)])
        {
            wanted.push((Vivace { shrink, seed: 0, conflict }, is_min_degree));
        }
    }
    let seeds = context.sizes.ablation_seeds;
    let effort = Effort { most: seeds, fewest: seeds, seconds: f64::INFINITY, balance: false };
    let mut settings = run(context, model, &wanted, effort)?;
    // Algorithm 2 as printed does not end by itself: each run goes on to the bound on rounds.
    let printed = Vivace { conflict: ConflictRule::None, ..Vivace::DEFAULT };
    let few = Effort { most: seeds.min(2), fewest: seeds.min(2), ..effort };
    settings.extend(run(context, model, &[(printed, false)], few)?);
    Ok(Ablation {
        family,
        n_vertices: graph.n_vertices(),
        min_degree: graph.min_degree(),
        max_degree: graph.max_degree(),
        settings,
    })
}

fn run(
    context: &Context<'_>,
    model: &Model,
    wanted: &[(Vivace, bool)],
    effort: Effort,
) -> Result<Vec<Setting>, FigureError> {
    let method = |vivace| Method { algorithm: Algorithm::Vivace(vivace), ..Method::VIVACE };
    let methods: Vec<Method> = wanted.iter().map(|&(vivace, _)| method(vivace)).collect();
    let measured = measure(context.devices(), &model.graph, &methods, effort, context.seed)?;
    let setting = |(measured, &(vivace, is_min_degree))| Setting { vivace, is_min_degree, measured };
    Ok(measured.into_iter().zip(wanted).map(setting).collect())
}

/// Colors, rounds and visits against s.
pub fn chart(families: &Families, ablations: &[Ablation]) -> Chart {
    let mut chart =
        Chart::new("What the shrink factor s and the conflict rule do (Algorithm 2)", 3).area(250.0, 170.0);
    for ablation in ablations {
        let name = families.name(ablation.family);
        let x = || Axis::linear("Shrink factor s").min(1.0).max(6.5);
        let panels = [
            (Axis::linear("Number of colors").whole().min(0.0), colors as fn(&Run) -> f64),
            (Axis::log("Rounds"), rounds),
            (Axis::linear("Visits per vertex").min(1.0), visits),
        ];
        for (y, of) in panels {
            // Room for the word at the line of reference.
            let highest = ablation.curves().map(|s| s.measured.quantile(0.75, of)).fold(1.0, f64::max);
            let room = if y.scale == Scale::Log { 1.5 } else { 1.2 };
            let mut panel = Panel::new(name, x(), y.max(room * highest)).guide_x(2.5, "default");
            for (rule, name) in [
                (ConflictRule::HighestHash, "Priority by hash (default)"),
                (ConflictRule::HighestIndex, "Priority by index (the paper)"),
            ] {
                let mut series = Series::new(name);
                for shrink in SHRINKS {
                    if let Some(setting) = ablation.at(shrink, rule) {
                        series = series.samples(f64::from(shrink), &setting.measured.samples(of));
                    }
                }
                panel = panel.series(series);
            }
            chart = chart.panel(panel);
        }
    }
    if let Some(ablation) = ablations.first() {
        let n = (ablation.n_vertices + 500) / 1000;
        chart = chart.note(&format!("Graphs of about {n}K vertices. Smaller s: larger palettes at the start, more colors. Larger s: more rounds."));
        if let Some(s) = smallest_good(ablations) {
            chart = chart.note(&format!(
                "Smallest s, by hash, within one color of the fewest on every one of these graphs: {s}."
            ));
        }
    }
    chart
}

/// The smallest factor that, with hashed priorities, comes within one color of the fewest on every graph: what explains the
/// default.
fn smallest_good(ablations: &[Ablation]) -> Option<f32> {
    let colors = |a: &Ablation, s: f32| a.at(s, ConflictRule::HighestHash).map_or(f64::NAN, Setting::colors);
    let fewest = |a: &Ablation| a.curves().map(Setting::colors).fold(f64::INFINITY, f64::min);
    let is_good = |s: f32| ablations.iter().all(|a| colors(a, s) <= fewest(a) + 1.0);
    SHRINKS.into_iter().find(|&s| is_good(s))
}

fn colors(run: &Run) -> f64 {
    f64::from(run.colors)
}

fn rounds(run: &Run) -> f64 {
    f64::from(run.rounds)
}

fn visits(run: &Run) -> f64 {
    run.visits
}

/// A row for each setting, for a reader.
pub fn table(families: &Families, ablations: &[Ablation]) -> Table {
    let mut columns = vec!["Shrink factor s".to_owned(), "Priority".to_owned()];
    for ablation in ablations {
        columns.push(format!("{}, min. degree {}", families.name(ablation.family), ablation.min_degree));
    }
    let mut table = Table::new("Colors / rounds / visits per vertex (medians) of Algorithm 2", &[]);
    table.columns = columns;
    let n_settings = ablations.iter().map(|a| a.settings.len()).min().unwrap_or(0);
    for idx in 0..n_settings {
        let first = &ablations[0].settings[idx];
        let shrink = match first.shrink() {
            _ if first.is_min_degree => "min. degree, in [1.5, 8]".to_owned(),
            Value::Real(s) if s.is_infinite() => "\u{221e} (first fit in rounds)".to_owned(),
            other => format!("{:.1}", if let Value::Real(s) = other { s } else { f64::NAN }),
        };
        let mut row: Vec<Value> = vec![shrink.into(), rule_name(first.vivace.conflict).into()];
        for ablation in ablations {
            let s = &ablation.settings[idx];
            let tail = match s.stragglers() {
                0 => String::new(),
                n => format!(" ({} left at the bound)", Value::from(n).shown()),
            };
            row.push(format!("{} / {} / {:.2}{tail}", s.colors(), s.rounds(), s.median(visits)).into());
        }
        table.push(row);
    }
    table
}

/// A row for each graph and setting.
pub fn data(ablations: &[Ablation]) -> Table {
    let mut table = Table::new(
        "ablation",
        &[
            "family",
            "vertices",
            "min_degree",
            "max_degree",
            "shrink",
            "is_min_degree",
            "rule",
            "runs",
            "colors",
            "colors_min",
            "colors_max",
            "rounds",
            "visits_per_vertex",
            "time_ms",
            "stragglers",
        ],
    );
    for ablation in ablations {
        for s in &ablation.settings {
            table.push([
                ablation.family.id().into(),
                ablation.n_vertices.into(),
                ablation.min_degree.into(),
                ablation.max_degree.into(),
                s.shrink(),
                s.is_min_degree.into(),
                rule_name(s.vivace.conflict).into(),
                s.measured.runs.len().into(),
                s.colors().into(),
                s.measured.quantile(0.0, colors).into(),
                s.measured.quantile(1.0, colors).into(),
                s.rounds().into(),
                s.median(visits).into(),
                s.median(|run| run.ms).into(),
                s.stragglers().into(),
            ]);
        }
    }
    table
}
