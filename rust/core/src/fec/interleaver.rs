//! The 36 x 48 block interleaver of B-CNAV1 (BDS-SIS-ICD-B1C-1.0 section 6.2.2.4).
//!
//! Symbols are written by rows and sent by columns. Of each three rows the first two are of
//! subframe 2 and the third is of subframe 3, eleven times; the last three rows are of subframe 2.

/// Rows and columns.
pub const ROWS: usize = 36;
/// Symbols of a row.
pub const COLUMNS: usize = 48;
/// Symbols of subframe 2, of 25 rows.
pub const SUBFRAME2: usize = 25 * COLUMNS;
/// Symbols of subframe 3, of 11 rows.
pub const SUBFRAME3: usize = 11 * COLUMNS;
/// Symbols of both.
pub const LENGTH: usize = ROWS * COLUMNS;

/// Whether a row is of subframe 3, and which of its subframe's rows it is.
fn row_of(row: usize) -> (bool, usize) {
    match row {
        33.. => (false, row - 11),
        _ if row % 3 == 2 => (true, row / 3),
        _ => (false, row - row / 3),
    }
}

/// Symbols as sent, 1728 of them.
///
/// # Panics
/// If the lengths are not those of the subframes.
pub fn interleave<T: Copy>(subframe2: &[T], subframe3: &[T]) -> Vec<T> {
    assert_eq!((subframe2.len(), subframe3.len()), (SUBFRAME2, SUBFRAME3));
    (0..LENGTH)
        .map(|k| {
            let (third, row) = row_of(k % ROWS);
            let from = if third { subframe3 } else { subframe2 };
            from[row * COLUMNS + k / ROWS]
        })
        .collect()
}

/// Subframes 2 and 3 from symbols as sent.
///
/// # Panics
/// If there are not 1728.
pub fn deinterleave<T: Copy + Default>(symbols: &[T]) -> (Vec<T>, Vec<T>) {
    assert_eq!(symbols.len(), LENGTH);
    let mut subframes = (vec![T::default(); SUBFRAME2], vec![T::default(); SUBFRAME3]);
    for (k, &symbol) in symbols.iter().enumerate() {
        let (third, row) = row_of(k % ROWS);
        let to = if third {
            &mut subframes.1
        } else {
            &mut subframes.0
        };
        to[row * COLUMNS + k / ROWS] = symbol;
    }
    subframes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_column_takes_the_first_of_each_row() {
        let second: Vec<i32> = (0..SUBFRAME2 as i32).collect();
        let third: Vec<i32> = (0..SUBFRAME3 as i32).map(|k| -1 - k).collect();
        let sent = interleave(&second, &third);
        assert_eq!(sent[..7], [0, 48, -1, 96, 144, -49, 192]);
        assert_eq!(
            sent[30..36],
            [20 * 48, 21 * 48, -481, 22 * 48, 23 * 48, 24 * 48]
        );
        assert_eq!(sent[36..39], [1, 49, -2]);
        assert_eq!(deinterleave(&sent), (second, third));
    }
}
