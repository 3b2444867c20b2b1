// What particles keep of the colors that their contacts have, or want. See draw_color.rs.

const N_COLORS = 64u;
const NO_COLOR = 0xffffffffu;
const TAKEN = 0u;
const FREE = 0xffffffffu;

fn entry(particle: u32, color: u32, mask: u32) -> u32 {
    return pcg(particle * N_COLORS + color) & mask;
}

fn is_free(contact: Contact, slot: u32) -> bool {
    return (contact.free & (1u << slot)) != 0u;
}
