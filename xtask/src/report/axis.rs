//! Axes: range, place of a value, ticks and their labels.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "exponents and tick counts are small"
)]

/// How values are spread along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps are equal differences.
    Linear,
    /// Equal steps are equal factors; values of 0 and below have no place.
    Log,
}

/// What an axis shows.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Quantity.
    pub label: String,
    /// Unit, shown in brackets.
    pub unit: Option<String>,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Lower end; by default fitted to the data.
    pub min: Option<f64>,
    /// Upper end; by default fitted to the data. Values beyond are cut off, so that a divergent series leaves the picture.
    pub max: Option<f64>,
    /// Labels as 10K and 1M.
    pub compact: bool,
    /// No ticks between whole numbers.
    pub whole: bool,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: &str) -> Self {
        let (unit, min, max) = (None, None, None);
        Self { label: label.to_owned(), unit, scale: Scale::Linear, min, max, compact: false, whole: false }
    }

    /// A logarithmic axis.
    pub fn log(label: &str) -> Self {
        Self { scale: Scale::Log, ..Self::linear(label) }
    }

    /// With a unit.
    #[must_use]
    pub fn unit(mut self, unit: &str) -> Self {
        self.unit = Some(unit.to_owned());
        self
    }

    /// With a fixed lower end.
    #[must_use]
    pub fn min(mut self, min: f64) -> Self {
        self.min = Some(min);
        self
    }

    /// With a fixed upper end.
    #[must_use]
    pub fn max(mut self, max: f64) -> Self {
        self.max = Some(max);
        self
    }

    /// With labels such as 10K and 1M.
    #[must_use]
    pub fn compact(mut self) -> Self {
        self.compact = true;
        self
    }

    /// With ticks at whole numbers only.
    #[must_use]
    pub fn whole(mut self) -> Self {
        self.whole = true;
        self
    }

    /// `label [unit]`.
    pub fn title(&self) -> String {
        match &self.unit {
            Some(unit) => format!("{} [{unit}]", self.label),
            None => self.label.clone(),
        }
    }
}

/// A tick's label.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Label {
    /// Plain text.
    Text(String),
    /// A digit times a power of ten.
    Power(i32, i32),
}

/// A tick; minor ones have no label.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) label: Option<Label>,
}

/// An axis whose ends are known.
#[derive(Clone, Debug)]
pub(super) struct Span {
    scale: Scale,
    pub(super) lo: f64,
    pub(super) hi: f64,
    compact: bool,
    whole: bool,
}

impl Span {
    /// Fits `axis` to `values`; those without a place on it are passed over.
    pub(super) fn fit(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let log = axis.scale == Scale::Log;
        let shown = |v: &f64| v.is_finite() && (!log || *v > 0.0);
        // Room for padding and for differences of the ends.
        let within = |v: f64| if log { v.clamp(1e-300, 1e300) } else { v.clamp(-1e300, 1e300) };
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(shown).map(within) {
            lo = lo.min(value);
            hi = hi.max(value);
        }
        if lo > hi {
            (lo, hi) = if log { (1.0, 10.0) } else { (0.0, 1.0) };
        }
        let (fixed_lo, fixed_hi) = (axis.min.filter(shown), axis.max.filter(shown));
        (lo, hi) = (fixed_lo.unwrap_or(lo), fixed_hi.unwrap_or(hi));
        let (padded_lo, padded_hi) = if log {
            let pad = if hi / lo < 1.05 { 2.0 } else { (0.05 * (hi.ln() - lo.ln())).exp().max(1.05) };
            (lo / pad, hi * pad)
        } else {
            let floor = if lo >= 0.0 { 0.0 } else { f64::NEG_INFINITY };
            let pad =
                if hi - lo > 1e-12 * hi.abs().max(lo.abs()) { 0.05 * (hi - lo) } else { 0.5 * hi.abs() };
            let pad = if pad > 0.0 { pad } else { 1.0 };
            ((lo - pad).max(floor), hi + pad)
        };
        let (lo, hi) = (fixed_lo.unwrap_or(padded_lo), fixed_hi.unwrap_or(padded_hi));
        let (lo, hi) = (within(lo), within(hi));
        let hi = if hi > lo { hi } else { lo + lo.abs().max(1.0) };
        Self { scale: axis.scale, lo, hi, compact: axis.compact, whole: axis.whole }
    }

    /// Where `value` lies: 0 at the lower end, 1 at the upper; none if it has no place.
    pub(super) fn place(&self, value: f64) -> Option<f64> {
        let at = match self.scale {
            Scale::Linear => (value - self.lo) / (self.hi - self.lo),
            Scale::Log if value > 0.0 => (value.ln() - self.lo.ln()) / (self.hi.ln() - self.lo.ln()),
            Scale::Log => return None,
        };
        at.is_finite().then_some(at)
    }

    /// Whether `value` lies between the ends.
    pub(super) fn holds(&self, value: f64) -> bool {
        self.place(value).is_some_and(|at| (-1e-9..=1.0 + 1e-9).contains(&at))
    }

    /// Major ticks, at most about `most` of them, and minor ones.
    pub(super) fn ticks(&self, most: usize) -> Vec<Tick> {
        match self.scale {
            Scale::Linear => self.linear_ticks(most.max(2)),
            Scale::Log => self.log_ticks(most.max(2)),
        }
    }

    fn linear_ticks(&self, most: usize) -> Vec<Tick> {
        let mut step = nice_step((self.hi - self.lo) / most as f64);
        if self.whole {
            step = step.max(1.0);
        }
        let lead = step / 10f64.powf(step.log10().floor() + 1e-9).max(f64::MIN_POSITIVE);
        let mut parts = if (1.5..3.0).contains(&lead) { 4.0 } else { 5.0 };
        if self.whole && step / parts < 1.0 {
            parts = if step > 1.5 { step } else { 1.0 };
        }
        let minor = step / parts;
        let decimals = if step < 1.0 { (-step.log10().floor() + 1e-9) as usize } else { 0 };
        let first = (self.lo / minor - 1e-6).ceil();
        let count = ((self.hi / minor + 1e-6).floor() - first).clamp(-1.0, 500.0) as i32 + 1;
        let ticks = (0..count).map(|idx| {
            let index = first + f64::from(idx);
            let value = index * minor;
            let is_major = (index / parts - (index / parts).round()).abs() < 1e-6;
            let text = || if self.compact { compact(value) } else { grouped(value, decimals) };
            Tick { value, label: is_major.then(|| Label::Text(text())) }
        });
        ticks.collect()
    }

    fn log_ticks(&self, most: usize) -> Vec<Tick> {
        let (low, high) = (self.lo.log10(), self.hi.log10());
        let (first, last) = ((low + 1e-9).floor() as i32, (high + 1e-9).floor() as i32);
        let n_decades = (last - (low - 1e-9).ceil() as i32 + 1).max(0);
        let most_decades = i32::try_from(most).unwrap_or(i32::MAX);
        let stride = (n_decades.max(1) - 1) / most_decades + 1;
        let mut digits: &[i32] = &[1];
        if n_decades < 3 && high - low < 2.2 {
            digits = &[1, 2, 5];
            let labeled = (first..=last)
                .flat_map(|exp| digits.iter().map(move |d| f64::from(*d) * 10f64.powi(exp)))
                .filter(|v| self.holds(*v))
                .count();
            if labeled < 2 {
                digits = &[1, 2, 3, 4, 5, 6, 7, 8, 9];
            } else if labeled > most {
                digits = &[1];
            }
        }
        let powers = !self.compact && (low < -3.3 || high > 5.3 || high - low > 7.0);
        let mut ticks = Vec::new();
        for exp in first..=last {
            let on_stride = exp.rem_euclid(stride) == 0;
            for digit in 1..=9 {
                let value = f64::from(digit) * 10f64.powi(exp);
                if !self.holds(value) || (stride > 1 && digit > 1) || (stride > 5 && !on_stride) {
                    continue;
                }
                let labeled = on_stride && digits.contains(&digit);
                ticks.push(Tick { value, label: labeled.then(|| self.log_label(digit, exp, powers)) });
            }
        }
        ticks
    }

    fn log_label(&self, digit: i32, exp: i32, powers: bool) -> Label {
        let value = f64::from(digit) * 10f64.powi(exp);
        match () {
            () if powers => Label::Power(digit, exp),
            () if self.compact => Label::Text(compact(value)),
            () => Label::Text(grouped(value, usize::try_from(-exp).unwrap_or(0))),
        }
    }
}

fn nice_step(rough: f64) -> f64 {
    let unit = 10f64.powf(rough.log10().floor());
    let lead = rough / unit;
    let nice = [1.0, 2.0, 5.0].into_iter().find(|nice| lead <= nice * 1.0001).unwrap_or(10.0);
    nice * unit
}

/// A number with `decimals` and a comma between groups of three digits.
pub fn grouped(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let (whole, fraction) = text.split_once('.').unwrap_or((&text, ""));
    let mut out = String::new();
    if value < 0.0 && text.chars().any(|c| c.is_ascii_digit() && c != '0') {
        out.push('\u{2212}');
    }
    for (idx, digit) in whole.chars().enumerate() {
        if idx > 0 && (whole.len() - idx) % 3 == 0 {
            out.push(',');
        }
        out.push(digit);
    }
    if !fraction.is_empty() {
        out.push('.');
        out.push_str(fraction);
    }
    out
}

/// A number as 250, 10K or 1.5M.
pub fn compact(value: f64) -> String {
    let (scaled, suffix) = match value.abs() {
        size if size >= 0.9995e9 => (value / 1e9, "G"),
        size if size >= 0.9995e6 => (value / 1e6, "M"),
        size if size >= 0.9995e3 => (value / 1e3, "K"),
        _ => (value, ""),
    };
    let decimals = if scaled.abs() >= 100.0 || (scaled - scaled.round()).abs() < 1e-6 {
        0
    } else if scaled.abs() >= 1.0 {
        1
    } else {
        3
    };
    let text = grouped(scaled, decimals);
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{short}{suffix}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, values: &[f64], most: usize) -> Vec<String> {
        let ticks = Span::fit(axis, values.iter().copied()).ticks(most);
        let text = |label| match label {
            Label::Text(text) => text,
            Label::Power(digit, exp) => format!("{digit}e{exp}"),
        };
        ticks.into_iter().filter_map(|tick| tick.label.map(text)).collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        let linear = Axis::linear("x");
        assert_eq!(labels(&linear, &[0.0, 10.0], 6), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels(&linear, &[-1.0, 1.0], 5), ["\u{2212}1.0", "\u{2212}0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(&linear.clone().whole(), &[6.0, 7.0], 8), ["6", "7"]);
        assert_eq!(labels(&linear, &[0.0, 2e6], 3), ["0", "1,000,000", "2,000,000"]);
        let log = Axis::log("x");
        assert_eq!(labels(&log, &[0.02, 300.0], 8), ["0.1", "1", "10", "100"]);
        assert_eq!(labels(&log.clone().compact(), &[1e3, 1e6], 8), ["1K", "10K", "100K", "1M"]);
        assert_eq!(labels(&log, &[1e-12, 1.0], 7), ["1e-12", "1e-10", "1e-8", "1e-6", "1e-4", "1e-2", "1e0"]);
        assert_eq!(labels(&log, &[3.0, 20.0], 8), ["5", "10", "20"]);
        assert_eq!(labels(&log, &[3.0, 4.0], 8), ["3", "4"]);
    }

    #[test]
    fn odd_data_still_gives_an_axis() {
        for axis in [Axis::linear("x"), Axis::log("x")] {
            for values in [
                &[][..],
                &[f64::NAN, f64::INFINITY],
                &[0.0],
                &[5.0],
                &[-3.0],
                &[1e-300, 1e300],
                &[-1e308, 1e308],
            ] {
                let span = Span::fit(&axis, values.iter().copied());
                assert!(
                    span.lo.is_finite() && span.hi.is_finite() && span.lo < span.hi,
                    "{axis:?} {values:?} {span:?}"
                );
                assert!(span.ticks(6).len() < 600);
            }
        }
        let upside_down = Span::fit(&Axis::linear("x").min(3.0).max(1.0), [2.0].into_iter());
        assert!(upside_down.lo < upside_down.hi);
        assert_eq!(Span::fit(&Axis::log("x"), [1.0].into_iter()).place(0.0), None);
    }

    #[test]
    fn numbers_read_well() {
        assert_eq!(grouped(1234567.0, 0), "1,234,567");
        assert_eq!(grouped(-0.04, 1), "0.0");
        assert_eq!(grouped(-1234.5, 1), "\u{2212}1,234.5");
        assert_eq!(compact(1_500_000.0), "1.5M");
        assert_eq!(compact(999.0), "999");
        assert_eq!(compact(100_000.0), "100K");
        assert_eq!(compact(0.25), "0.25");
    }
}
