// What a select has decided, group by group: a bit for each element, and how many were selected in the groups before.

struct Decisions {
    bits: array<u32, 8>,
    before: u32,
}
