//! Subframes of D1 and D2, and the doubt in words that a code cannot check.

use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use sdr_spoof_core::fec::beidou_subframe as subframe;
use sdr_spoof_core::fec::{bch15, doubt};

use crate::fec::{rows_of, same, table, Rows};

/// (bits, symbols as sent) of subframes of D1 and D2, both (F, 300), from bits in the ICD's order,
/// whose parity is filled in.
#[pyfunction]
fn d1_encode<'py>(
    py: Python<'py>,
    bits: PyReadonlyArray2<'py, u8>,
) -> PyResult<(Rows<'py>, Rows<'py>)> {
    let mut rows = rows_of::<u8, { subframe::SUBFRAME }>(&bits)?;
    let sent = rows.iter_mut().flat_map(subframe::encode).collect();
    let bits = rows.into_iter().flatten().collect();
    let columns = subframe::SUBFRAME;
    Ok((table(py, bits, columns)?, table(py, sent, columns)?))
}

type Places<'py> = Bound<'py, PyArray2<i64>>;
type Subframes<'py> = (
    Rows<'py>,
    Bound<'py, PyArray2<i64>>,
    Bound<'py, PyArray2<f64>>,
);

/// Most likely bits (F, 300), those changed and the doubt in each code word (F, 19), of soft symbols
/// (F, 300) of amplitude 1 in noise of that standard deviation.
#[pyfunction]
fn d1_decode<'py>(
    py: Python<'py>,
    values: PyReadonlyArray2<'py, f32>,
    noise: f64,
) -> PyResult<Subframes<'py>> {
    let rows = rows_of::<f32, { subframe::SUBFRAME }>(&values)?;
    let decode = |row| subframe::decode(row, noise);
    subframes(py, py.detach(|| rows.iter().map(decode).collect()))
}

/// The same of hard symbols (F, 300), one error of a code word repaired; no doubt is told.
#[pyfunction]
fn d1_correct<'py>(
    py: Python<'py>,
    symbols: PyReadonlyArray2<'py, u8>,
) -> PyResult<Subframes<'py>> {
    let rows = rows_of::<u8, { subframe::SUBFRAME }>(&symbols)?;
    subframes(py, rows.iter().map(subframe::correct).collect())
}

/// Which code words of hard symbols (F, 300) are none, (F, 19).
#[pyfunction]
fn d1_wrong_blocks<'py>(
    py: Python<'py>,
    symbols: PyReadonlyArray2<'py, u8>,
) -> PyResult<Bound<'py, PyArray2<bool>>> {
    let rows = rows_of::<u8, { subframe::SUBFRAME }>(&symbols)?;
    table(
        py,
        rows.iter().flat_map(subframe::wrong_blocks).collect(),
        subframe::BLOCKS,
    )
}

/// Where the code words' bits lie as sent and in the ICD's order, both (19, 15).
#[pyfunction]
fn d1_layout(py: Python<'_>) -> PyResult<(Places<'_>, Places<'_>)> {
    let of = |layout: fn(usize) -> [usize; bch15::LENGTH]| {
        let rows = (0..subframe::BLOCKS).flat_map(layout);
        table(py, rows.map(|k| k as i64).collect(), bch15::LENGTH)
    };
    Ok((of(subframe::sent)?, of(subframe::places)?))
}

fn subframes(py: Python<'_>, found: Vec<subframe::Decoded>) -> PyResult<Subframes<'_>> {
    let bits = found.iter().flat_map(|d| d.bits).collect();
    let corrected = found.iter().flat_map(|d| d.corrected).map(|n| n as i64);
    let doubt = found.iter().flat_map(|d| d.doubt).collect();
    Ok((
        table(py, bits, subframe::SUBFRAME)?,
        table(py, corrected.collect(), subframe::BLOCKS)?,
        table(py, doubt, subframe::BLOCKS)?,
    ))
}

/// Probability (N,) that the cheapest of several explanations (N, K) of words is wrong, see
/// `sdr_spoof_core::fec::doubt`; magnitudes of their symbols (N, S).
#[pyfunction]
fn word_doubt<'py>(
    py: Python<'py>,
    costs: PyReadonlyArray2<'py, f64>,
    magnitudes: PyReadonlyArray2<'py, f64>,
    more: usize,
    noise: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (words, symbols) = (costs.shape()[0], magnitudes.shape()[1]);
    same("rows of magnitudes", magnitudes.shape()[0], words)?;
    let (costs, columns) = (costs.as_slice()?, costs.shape()[1]);
    let magnitudes = magnitudes.as_slice()?;
    let of = |k: usize| {
        let mut own = magnitudes[k * symbols..][..symbols].to_vec();
        doubt(&costs[k * columns..][..columns], &mut own, more, noise)
    };
    Ok((0..words).map(of).collect::<Vec<_>>().into_pyarray(py))
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(d1_encode, m)?)?;
    m.add_function(wrap_pyfunction!(d1_decode, m)?)?;
    m.add_function(wrap_pyfunction!(d1_correct, m)?)?;
    m.add_function(wrap_pyfunction!(d1_wrong_blocks, m)?)?;
    m.add_function(wrap_pyfunction!(d1_layout, m)?)?;
    m.add_function(wrap_pyfunction!(word_doubt, m)?)?;
    Ok(())
}
