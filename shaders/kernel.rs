//! What a kernel is.

use bytemuck::Pod;

/// What an array may hold: plain data that any thread may read.
pub trait Element: Pod + Send + Sync {}
impl<T: Pod + Send + Sync> Element for T {}

/// Where a backend keeps its data, and what a read-only view of an array is there.
pub trait Memory: 'static {
    /// A read-only view of an array of `T`.
    type View<'a, T: Element>: Copy + Send + Sync;

    /// The same view for a shorter time. (The compiler cannot see that this is always possible.)
    fn shorten<'short, 'long: 'short, T: Element>(view: Self::View<'long, T>) -> Self::View<'short, T>;
}

/// The host's own memory: a view is a slice.
#[derive(Debug)]
pub struct Host;

impl Memory for Host {
    type View<'a, T: Element> = &'a [T];

    fn shorten<'short, 'long: 'short, T: Element>(view: &'long [T]) -> &'short [T] {
        view
    }
}

/// One kernel: a function of an index, a few parameters and some read-only arrays. It comes in seven forms, by what it writes:
/// [`Map`], [`Update`], [`Scatter`], [`Select`], [`Expand`], [`CountDown`], [`Lower`].
pub trait Kernel: 'static {
    /// The kernel's one name: file stem, label, row in a timing table.
    const NAME: &'static str;
    /// The function's twin in WGSL, in parts that are joined: what kernels share, then its own file. [`crate::Form`] says how it is
    /// called there and what it binds.
    const WGSL: &'static [&'static str];
    /// Parameters, the same for every invocation; `()` where there are none.
    type Uniform: Element;
    /// Element types of the read-only arrays: a tuple, in binding order.
    type Inputs: Inputs;
}

/// A kernel that computes element `i` of an array of which it reads no other element.
pub trait Map: Kernel {
    /// Element type of the array written.
    type Output: Element;
    /// Computes element `i`, here `own`, from the other arrays and its old value.
    fn map(i: u32, uniform: &Self::Uniform, inputs: HostViews<'_, Self>, own: &mut Self::Output);
}

/// A kernel that computes element `i` of an array of which it reads other elements. Invocations of one run read no element that
/// another of them writes: the elements of an independent set read their neighbors and themselves.
pub trait Update: Kernel {
    /// Element type of the array read and written.
    type State: Element;
    /// The new value of element `i`.
    fn update(
        i: u32,
        uniform: &Self::Uniform,
        inputs: HostViews<'_, Self>,
        state: &[Self::State],
    ) -> Self::State;
}

/// A kernel that writes up to `N` elements of an array, and element `i` of another. Invocations of one run neither read nor write an
/// element that another of them writes: the constraints of one color, which share no particle that moves.
pub trait Scatter<const N: usize>: Kernel {
    /// Element type of the array read and written.
    type State: Element;
    /// Element type of the array of which only element `i` is read and written.
    type Own: Element;
    /// The elements of `state` that `i` writes, with their new values; changes `own`, element `i` of the other array.
    fn scatter(
        i: u32,
        uniform: &Self::Uniform,
        inputs: HostViews<'_, Self>,
        state: &[Self::State],
        own: &mut Self::Own,
    ) -> [Option<(u32, Self::State)>; N];
}

/// A kernel that decides whether `i` moves from one list to another. Like a [`Map`], it may write one element on the way.
pub trait Select: Kernel {
    /// Element type of the array written.
    type Output: Element;
    /// Whether `i` is selected; `own` is its element.
    fn select(i: u32, uniform: &Self::Uniform, inputs: HostViews<'_, Self>, own: &mut Self::Output) -> bool;
}

/// A kernel of which each invocation finds any number of items: pairs that meet. They are listed invocation by invocation, so order does
/// not show.
pub trait Expand: Kernel {
    /// What it finds.
    type Item: Element;
    /// Gives each item of `i` to `emit`.
    fn expand(
        i: u32,
        uniform: &Self::Uniform,
        inputs: HostViews<'_, Self>,
        emit: &mut impl FnMut(Self::Item),
    );
}

/// A kernel that counts down: invocations write the same elements, but integer subtraction commutes, so order does not show.
pub trait CountDown: Kernel {
    /// The counters that `i` takes one from, ascending; a counter at 0 stays 0.
    fn targets<'a>(i: u32, uniform: &Self::Uniform, inputs: HostViews<'a, Self>) -> &'a [u32];
}

/// A kernel that lowers up to `N` elements to values of its own: invocations write the same elements, but the minimum of integers commutes,
/// so order does not show. (Floating-point numbers that are not negative are ordered as their bits are.)
pub trait Lower<const N: usize>: Kernel {
    /// Elements, and the values that they are no more than afterwards.
    fn lower(i: u32, uniform: &Self::Uniform, inputs: HostViews<'_, Self>) -> [Option<(u32, u32)>; N];
}

/// The views that kernel `K` takes, in memory `M`.
pub type Views<'a, K, M> = <<K as Kernel>::Inputs as Inputs>::Views<'a, M>;
/// The slices that kernel `K` takes on the host.
pub type HostViews<'a, K> = Views<'a, K, Host>;

/// A tuple of element types, one for each array that a kernel reads.
pub trait Inputs: 'static {
    /// How many there are.
    const LEN: usize;
    /// The tuple of views.
    type Views<'a, M: Memory>: Copy + Send + Sync;

    /// Shows each view to `visitor`, in binding order: how a device binds them.
    fn visit<'a, M: Memory>(views: Self::Views<'a, M>, visitor: &mut impl ViewVisitor<'a, M>);
}

/// Takes the views of a kernel's inputs one by one.
pub trait ViewVisitor<'a, M: Memory> {
    /// The next view, in binding order.
    fn view<T: Element>(&mut self, view: M::View<'a, T>);
}

macro_rules! inputs {
    ($($element:ident $view:ident),*) => {
        impl<$($element: Element),*> Inputs for ($($element,)*) {
            const LEN: usize = 0 $(+ { let $view = 1; $view })*;
            type Views<'a, M: Memory> = ($(M::View<'a, $element>,)*);

            #[allow(unused_variables, clippy::unused_unit, reason = "the empty tuple")]
            fn visit<'a, M: Memory>(($($view,)*): Self::Views<'a, M>, visitor: &mut impl ViewVisitor<'a, M>) {
                $(visitor.view::<$element>($view);)*
            }
        }
    };
}
inputs!();
inputs!(A a);
inputs!(A a, B b);
inputs!(A a, B b, C c);
inputs!(A a, B b, C c, D d);
inputs!(A a, B b, C c, D d, E e);
inputs!(A a, B b, C c, D d, E e, F f);
