//! How the WGSL of a kernel becomes a shader: its parts and its form's are joined, in the order in which they are listed.
//!
//! Bindings are the same for all kernels. Group 0 is the run: 0 the headers of lists, 1 the list, 2 which lists, 3 the kernel's
//! uniform, 4 what a select decided or where an expansion goes on. Group 1 is the kernel's: its inputs in order, then the arrays it writes.

use crate::{CountDown, Expand, Inputs, Kernel, Lower, Map, Scatter, Select, Update};

/// In which way a kernel runs over a list, and what its function is called in WGSL.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Form {
    /// `map(i)` writes element `i`.
    Map,
    /// `update(i)` writes element `i` of an array that it reads.
    Update,
    /// As `Update`, one invocation after another.
    UpdateInOrder,
    /// `scatter(i)` writes elements of one array that are its own in this run, and element `i` of another.
    Scatter,
    /// As `Scatter`, one invocation after another.
    ScatterInOrder,
    /// `select_element(i)` says whether `i` is selected, and may write element `i`. (`select` is taken in WGSL.)
    Select,
    /// `expand(i)` calls `next_place()` for each item that it finds, and writes it there if the array is as long.
    Expand,
    /// `count_down(i)` calls `take_one(target)`; the array is called `counters`.
    CountDown,
    /// `lower(i)` calls `lower_to(target, value)`; the array is called `lowest`.
    Lower,
}

impl Form {
    const fn wgsl(self) -> &'static [&'static str] {
        const OVER: &str = include_str!("device/over.wgsl");
        match self {
            Self::Map => &[RUN, OVER, include_str!("form/map.wgsl")],
            Self::Update => &[RUN, OVER, include_str!("form/update.wgsl")],
            Self::UpdateInOrder => &[RUN, OVER, include_str!("form/update_in_order.wgsl")],
            Self::Scatter => &[RUN, OVER, include_str!("form/scatter.wgsl")],
            Self::ScatterInOrder => &[RUN, OVER, include_str!("form/scatter_in_order.wgsl")],
            Self::Select => &[RUN, DECISIONS, OVER, include_str!("form/select.wgsl")],
            Self::Expand => &[RUN, PREFIX, PLACES, OVER, include_str!("form/expand.wgsl")],
            Self::CountDown => &[RUN, OVER, include_str!("form/count_down.wgsl")],
            Self::Lower => &[RUN, OVER, include_str!("form/lower.wgsl")],
        }
    }

    /// How many arrays a kernel of this form writes.
    #[must_use]
    pub const fn n_outputs(self) -> usize {
        match self {
            Self::Scatter | Self::ScatterInOrder => 2,
            _ => 1,
        }
    }

    /// Whether invocations run one after another.
    #[must_use]
    pub const fn is_in_order(self) -> bool {
        matches!(self, Self::UpdateInOrder | Self::ScatterInOrder)
    }
}

/// A kernel in one of its forms.
#[derive(Debug, Clone, Copy)]
pub struct Shader {
    /// The kernel's name.
    pub name: &'static str,
    /// The form.
    pub form: Form,
    /// How many arrays the kernel reads beside those it writes.
    pub n_inputs: usize,
    /// Bytes of its uniform.
    pub uniform_bytes: usize,
    parts: &'static [&'static str],
}

impl Shader {
    /// A map.
    #[must_use]
    pub const fn map<K: Map>() -> Self {
        Self::new::<K>(Form::Map)
    }

    /// An update, all elements at once.
    #[must_use]
    pub const fn update<K: Update>() -> Self {
        Self::new::<K>(Form::Update)
    }

    /// An update, one element after another.
    #[must_use]
    pub const fn update_in_order<K: Update>() -> Self {
        Self::new::<K>(Form::UpdateInOrder)
    }

    /// A scatter, all at once.
    #[must_use]
    pub const fn scatter<K: Scatter<N>, const N: usize>() -> Self {
        Self::new::<K>(Form::Scatter)
    }

    /// A scatter, one after another.
    #[must_use]
    pub const fn scatter_in_order<K: Scatter<N>, const N: usize>() -> Self {
        Self::new::<K>(Form::ScatterInOrder)
    }

    /// A select.
    #[must_use]
    pub const fn select<K: Select>() -> Self {
        Self::new::<K>(Form::Select)
    }

    /// An expansion.
    #[must_use]
    pub const fn expand<K: Expand>() -> Self {
        Self::new::<K>(Form::Expand)
    }

    /// A lowering.
    #[must_use]
    pub const fn lower<K: Lower<N>, const N: usize>() -> Self {
        Self::new::<K>(Form::Lower)
    }

    /// A countdown.
    #[must_use]
    pub const fn count_down<K: CountDown>() -> Self {
        Self::new::<K>(Form::CountDown)
    }

    const fn new<K: Kernel>(form: Form) -> Self {
        let (n_inputs, uniform_bytes) = (K::Inputs::LEN, size_of::<K::Uniform>());
        Self { name: K::NAME, form, n_inputs, uniform_bytes, parts: K::WGSL }
    }

    /// The text, entry point `main`.
    #[must_use]
    pub fn wgsl(&self) -> String {
        [self.form.wgsl(), self.parts].concat().join("\n")
    }
}

const RUN: &str = include_str!("device/run.wgsl");
const PREFIX: &str = include_str!("device/prefix.wgsl");
const DECISIONS: &str = include_str!("device/decisions.wgsl");
const PLACES: &str = include_str!("device/places.wgsl");

/// What a device does with arrays and lists between kernels. Its counterpart on the CPU is `vivace_cpu::List`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ListShader {
    /// Fills an array.
    Fill,
    /// Makes the list of all indices.
    All,
    /// After a select: how many were selected before each group, and the lengths of both lists.
    Scan,
    /// After a scan: the elements of both lists.
    Split,
    /// After an expansion has counted: where the items of each group go, and how many there are.
    Place,
    /// The first elements of a list, as many as its length says.
    Number,
    /// How many elements of each group have each key.
    CountKeys,
    /// After a count of keys: where the elements of each begin.
    ScanKeys,
    /// After a scan of keys: the elements of all lists.
    PlaceKeys,
}

/// Most keys of a sort, as in `run.wgsl`.
pub const MOST_KEYS: u32 = 64;

impl ListShader {
    /// Each of them.
    pub const ALL: [Self; 9] = [
        Self::Fill,
        Self::All,
        Self::Scan,
        Self::Split,
        Self::Place,
        Self::Number,
        Self::CountKeys,
        Self::ScanKeys,
        Self::PlaceKeys,
    ];

    /// File stem and label.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fill => "fill",
            Self::All => "all",
            Self::Scan => "scan",
            Self::Split => "split",
            Self::Place => "place",
            Self::Number => "number",
            Self::CountKeys => "count_keys",
            Self::ScanKeys => "scan_keys",
            Self::PlaceKeys => "place_keys",
        }
    }

    /// The text, entry point `main`.
    #[must_use]
    pub fn wgsl(self) -> String {
        let parts: &[&str] = match self {
            Self::Fill => &[RUN, include_str!("device/fill.wgsl")],
            Self::All => &[RUN, include_str!("device/all.wgsl")],
            Self::Scan => &[RUN, DECISIONS, PREFIX, include_str!("device/scan.wgsl")],
            Self::Split => &[RUN, DECISIONS, include_str!("device/split.wgsl")],
            Self::Place => &[RUN, PREFIX, PLACES, include_str!("device/place.wgsl")],
            Self::Number => &[RUN, include_str!("device/number.wgsl")],
            Self::CountKeys => &[RUN, include_str!("device/count_keys.wgsl")],
            Self::ScanKeys => &[RUN, PREFIX, include_str!("device/scan_keys.wgsl")],
            Self::PlaceKeys => &[RUN, include_str!("device/place_keys.wgsl")],
        };
        parts.join("\n")
    }
}
