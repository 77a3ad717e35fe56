"""Charts: where values lie, which ticks there are, and that the SVG is well formed."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from sdr_spoof.report.chart import Axis, Entry, Grid, Panel, drawing, scale, svg
from sdr_spoof.report.chart.marks import Note
from sdr_spoof.report.chart.picture import wrapped


def decoded(data):
    """Runs of points of a path, in units of a picture."""
    runs = []
    for piece in data.split("M")[1:]:
        numbers = np.array([int(n) for n in re.findall(r"-?\d+", piece.replace("h0", ""))])
        runs.append(np.cumsum(numbers.reshape(-1, 2), axis=0) / svg.FINE)
    return runs


def test_a_path_goes_through_its_points_and_breaks_at_gaps():
    x = np.array([0.0, 10.04, 20.0, 30.0, 40.0, 50.0])
    y = np.array([5.0, 4.0, np.nan, -3.0, 3.0, np.inf])
    first, second = decoded(svg.path(x, y))
    np.testing.assert_allclose(first, [[0.0, 5.0], [10.0, 4.0]])
    np.testing.assert_allclose(second, [[30.0, -3.0], [40.0, 3.0]])
    assert svg.path(x, np.full(6, np.nan)) == ""
    assert svg.path(np.array([1.0]), np.array([2.0])) == "M10 20h0"


def test_text_is_escaped():
    element = svg.text(1.0, 2.5, "<b>&", fill='"')
    assert ElementTree.fromstring(element).text == "<b>&"
    assert svg.element("a", stroke_width=1.005, class_=None) == '<a stroke-width="1"/>'


@pytest.mark.parametrize(
    ("low", "high", "most", "expected"),
    [
        (0.0, 12.0, 6, ["0", "2", "4", "6", "8", "10", "12"]),
        (-0.31, 0.29, 3, ["−0.2", "0.0", "0.2"]),
        (1559.0, 1563.0, 4, ["1559", "1560", "1561", "1562", "1563"]),
        (-1100.0, 260.0, 6, ["−1000", "−750", "−500", "−250", "0", "250"]),
        (0.0, 4e-6, 4, ["0", "1e−06", "2e−06", "3e−06", "4e−06"]),
    ],
)
def test_ticks_are_round_and_named_with_what_they_need(low, high, most, expected):
    assert scale.names(scale.ticks(low, high, most)) == expected


def test_symlog_is_smooth_enough_and_odd():
    turn = scale.Symlog(0.25, 0.9)
    np.testing.assert_allclose(turn([0.25, 2.5, 25.0]), [0.9, 1.9, 2.9])
    np.testing.assert_allclose(turn([-2.5, 0.0, 0.125]), [-1.9, 0.0, 0.45])
    inside = scale.Scale(-1.0, 10.0, turn).at([-1.0, 10.0])
    np.testing.assert_allclose(inside, [0.0, 1.0])


@pytest.mark.parametrize("reach", [(np.inf, -np.inf), (3.0, 3.0), (0.0, 0.0), (-2.0, 5.0)])
def test_limits_show_the_data_whatever_it_is(reach):
    low, high = scale.stretch(*reach, 0.05)
    assert np.isfinite([low, high]).all()
    assert low < high
    assert not np.isfinite(reach[0]) or low <= reach[0] <= reach[1] <= high


def small(**axes):
    panel = Panel("A title", **axes)
    time = np.linspace(0.0, 10.0, 50)
    panel.line(time, np.sin(time), "#000")
    panel.dots(time, np.cos(time), "#111", shape="cross")
    panel.area(time, -np.ones(50), np.ones(50), "#0f0", 0.1)
    panel.bar((1.0, 2.0), (0.0, 0.5), "#f00")
    panel.shade("#00f", 0.1, y=(-0.5, 0.5))
    panel.level(2.0, "#222")
    panel.moment(5.0, "#333", dash=(2, 2))
    panel.note(Note(5.0, 0.0, "here & now", "#444"))
    panel.entries.append(Entry("a line", "#000"))
    return panel


def test_a_picture_is_well_formed_and_the_same_twice():
    def draw():
        rows = [[small(), small()], [small(y=Axis("up\n(m)")), Panel()]]
        return drawing(
            Grid(rows, [100.0, 80.0], widths=[2.0, 1.0], share_x=True),
            Grid([[small(x=Axis("Time (s)"))]], [90.0], caption="below"),
            legend=[Entry("dot", "#000", shape="dot"), Entry("ring", "#000", shape="ring")],
        ).svg('what "it" shows')

    assert draw() == draw()
    root = ElementTree.fromstring(draw())
    assert root.get("aria-label") == 'what "it" shows'
    _, _, width, height = map(float, root.get("viewBox").split())
    assert width == 1000.0
    assert 100 + 80 + 90 < height < 520


def test_a_shared_axis_shows_all_of_a_column():
    low, high = Panel(), Panel()
    low.line(np.array([0.0, 1.0]), np.array([0.0, 1.0]), "#000")
    high.line(np.array([5.0, 9.0]), np.array([0.0, 100.0]), "#000")
    apart = Grid([[low], [high]], [50.0, 50.0], share_x=True)
    (first, _), (second, _) = (row[0] for row in apart._scales)
    assert first == second
    assert first.low < 0.0
    assert first.high > 9.0


def test_equal_axes_have_one_unit():
    panel = Panel(equal=True)
    panel.dots([0.0, 100.0], [0.0, 1.0], "#000", 5.0)
    panel.bar((0.0, 50.0), (0.0, 50.0), "#000")
    text, _ = Grid([[panel]], [200.0]).draw(1000.0)
    (bar,) = re.findall(r"<rect[^>]*>", text)
    width, height = (float(re.search(rf' {n}="([\d.]+)"', bar)[1]) for n in ("width", "height"))
    assert width == pytest.approx(height, rel=1e-3)


def test_a_legend_wraps():
    entries = [Entry("quite a long name of a line", "#000") for _ in range(6)]
    places = wrapped(entries, 500.0)
    assert [line for _, line in places] == sorted(line for _, line in places)
    assert {line for _, line in places} == {0, 1, 2}
    assert all(x < 500.0 for x, _ in places)
