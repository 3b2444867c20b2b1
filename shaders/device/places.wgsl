// Where the items of an expansion go, group by group: how many come before each invocation's in the group, how many in the group, and how
// many in the groups before.

struct Places {
    within: array<u32, GROUP>,
    sum: u32,
    before: u32,
}
