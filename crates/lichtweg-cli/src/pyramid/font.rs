//! Letters of 3 x 5 dots, for labels.

/// Height of a letter in dots.
pub const HEIGHT: usize = 5;
/// Width of a letter and the gap after it in dots.
pub const ADVANCE: usize = 4;

/// The rows of a letter, from the top, three bits each; blank where there is none.
fn rows(letter: char) -> [u8; HEIGHT] {
    match letter {
        '0' => [7, 5, 5, 5, 7],
        '1' => [2, 6, 2, 2, 7],
        '2' => [7, 1, 7, 4, 7],
        '3' => [7, 1, 7, 1, 7],
        '4' => [5, 5, 7, 1, 1],
        '5' => [7, 4, 7, 1, 7],
        '6' => [7, 4, 7, 5, 7],
        '7' => [7, 1, 2, 2, 2],
        '8' => [7, 5, 7, 5, 7],
        '9' => [7, 5, 7, 1, 7],
        's' => [3, 4, 2, 1, 6],
        't' => [2, 7, 2, 2, 3],
        'x' => [0, 5, 2, 5, 0],
        '=' => [0, 7, 0, 7, 0],
        '.' => [0, 0, 0, 0, 2],
        '%' => [5, 1, 2, 4, 5],
        _ => [0; HEIGHT],
    }
}

/// The dots of a line of text: column and row, from the top left corner.
pub fn dots(text: &str) -> impl Iterator<Item = [usize; 2]> + '_ {
    text.chars().enumerate().flat_map(|(i, letter)| {
        rows(letter).into_iter().enumerate().flat_map(move |(y, row)| {
            (0..3).filter(move |x| row >> (2 - x) & 1 == 1).map(move |x| [i * ADVANCE + x, y])
        })
    })
}
