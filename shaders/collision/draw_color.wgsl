// The coloring of contacts: each draws a color that its particles have not given away. See draw_color.rs.

struct Params {
    key: u32,
    mask: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> contacts: array<Contact>;
@group(1) @binding(1) var<storage, read> entries: array<u32>;
@group(1) @binding(2) var<storage, read_write> drawn: array<u32>;

fn is_left(contact: Contact, color: u32) -> bool {
    for (var slot = 0u; slot < 4u; slot++) {
        if is_free(contact, slot) && entries[entry(contact.particles[slot], color, params.mask)] == TAKEN {
            return false;
        }
    }
    return true;
}

fn map(i: u32) {
    let contact = contacts[i];
    let first = hash(i, params.key);
    for (var k = 0u; k < N_COLORS; k++) {
        let color = (first + k) % N_COLORS;
        if is_left(contact, color) {
            drawn[i] = color;
            return;
        }
    }
    drawn[i] = NO_COLOR;
}
