//! Corrections of controllers by their tables, written again from their manuals and sources: own readers, which take
//! only files as `compile` writes them, and own arithmetic, in the units that the controller counts in. Nothing here
//! knows how the program reads or interpolates. Sources are those of docs/controls, line by line below.

use std::collections::BTreeMap;

use super::{cec, comp, stacking};
use crate::oracle::machines::Sample;

/// Files of a set by name.
pub type Files = BTreeMap<String, String>;

/// Corrections of the axes, in the controller's order, at their positions (mm, deg); `true`: falling positions.
pub type Controller = Box<dyn Fn(&[f64], bool) -> Vec<f64>>;

/// The controller's axes: letter, and whether it turns without end.
pub type Axes<'a> = &'a [(char, bool)];

/// A controller with files loaded; none if this reader does not take them.
pub fn loaded(target: &str, files: &Files, axes: Axes, machine: &Sample) -> Option<Controller> {
    match target {
        "linuxcnc" => linuxcnc(files, axes),
        "sinumerik-enc" => encoder_error(files, axes),
        "sinumerik-cec" => cross_error(files, axes),
        "heidenhain-com" => com(files, axes),
        "fanuc-pitch" => pitch(files, axes),
        "fanuc-3d" => lattice_of_points(files, axes),
        "twincat-axis" => value_lists(files, axes),
        "pmac" => leadscrew(files, axes),
        "kmotion-geo" => geo(files, axes),
        "reprapfirmware" => duet(files, axes),
        "klipper" => skew(files, axes, ["xy_skew = ", "xz_skew = ", "yz_skew = "]),
        "marlin" => skew(files, axes, ["M852 I", "M852 J", "M852 K"]),
        "grbl" => steps(files, axes),
        "isg-volcomp" => volcomp(files.get("volcomp.csv")?, axes, machine),
        "etalon-exchange" => etalon(files.get("etalon.txt")?, axes, machine),
        "grid-json" => json(files.get("corrections.json")?, axes),
        _ => None,
    }
}

pub(super) fn real(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

fn at(axes: Axes, letter: char) -> Option<usize> {
    axes.iter().position(|(known, _)| *known == letter)
}

/// `NAME[...]=VALUE` and the like: the pieces of a line between any of these letters.
pub(super) fn pieces<'a>(line: &'a str, marks: &str) -> Vec<&'a str> {
    line.split(|c| marks.contains(c)).filter(|piece| !piece.is_empty()).collect()
}

/// Equidistant points from a start, in whatever unit; the end values hold.
#[derive(Clone, Debug)]
pub(super) struct Points {
    pub start: f64,
    pub step: f64,
    pub values: Vec<f64>,
    /// A turn, if the axis is looked up modulo.
    pub turn: Option<f64>,
}

impl Points {
    pub fn read(&self, position: f64) -> f64 {
        let mut way = position - self.start;
        if let Some(turn) = self.turn {
            way -= (way / turn).floor() * turn;
        }
        let last = self.values.len() - 1;
        let cells = way / self.step;
        if cells <= 0.0 {
            return self.values[0];
        }
        if cells >= last as f64 {
            return self.values[last];
        }
        let low = cells as usize;
        self.values[low] + (self.values[low + 1] - self.values[low]) * (cells - low as f64)
    }
}

/// Values numbered from 0 without a gap.
pub(super) fn numbered(values: &BTreeMap<usize, f64>) -> Option<Vec<f64>> {
    values.keys().enumerate().all(|(i, key)| i == *key).then(|| values.values().copied().collect())
}

/// LinuxCNC, compute_screw_comp and usrmotintf.cc: single precision, the end values held.
fn linuxcnc(files: &Files, axes: Axes) -> Option<Controller> {
    let name = |(joint, (letter, _)): (usize, &(char, bool))| format!("joint_{joint}_{letter}.comp");
    let tables: Option<Vec<comp::CorrectionTable>> =
        axes.iter().enumerate().map(|axis| comp::CorrectionTable::read(files.get(&name(axis))?).ok()).collect();
    let tables = tables?;
    Some(Box::new(move |q, reverse| tables.iter().zip(q).map(|(table, q)| table.added(*q, reverse)).collect()))
}

/// Siemens K3: points from MIN in steps of STEP (p. 240), straight between them, held outside; a positive value moves
/// the axis in its negative direction (p. 238); modulo 360 deg if set (p. 242).
fn encoder_error(files: &Files, axes: Axes) -> Option<Controller> {
    let mut tables: BTreeMap<usize, Points> = BTreeMap::new();
    for text in files.iter().filter(|(name, _)| name.ends_with("_EEC_INI")).map(|(_, text)| text) {
        let (mut values, mut axis) = (BTreeMap::new(), 0);
        let mut said = BTreeMap::new();
        for line in text.lines().filter(|line| line.starts_with("$AA_ENC_COMP")) {
            let parts = pieces(line, "[],=");
            match parts[..] {
                ["$AA_ENC_COMP", "0", index, ax, value] => {
                    axis = ax.strip_prefix("AX")?.parse().ok()?;
                    values.insert(index.parse().ok()?, real(value)?);
                }
                [name, "0", _, value] => drop(said.insert(name.to_owned(), real(value)?)),
                _ => return None,
            }
        }
        let of = |name: &str| said.get(&format!("$AA_ENC_COMP_{name}")).copied();
        let turn = (of("IS_MODULO")? == 1.0).then_some(360.0);
        let points = Points { start: of("MIN")?, step: of("STEP")?, values: numbered(&values)?, turn };
        tables.insert(axis - 1, points);
    }
    let count = axes.len();
    Some(Box::new(move |q, _| {
        let mut added = vec![0.0; count];
        tables.iter().for_each(|(axis, points)| added[*axis] -= points.read(q[*axis]));
        added
    }))
}

/// The same with tables over other axes ([`cec`]); both factors of a product count by themselves besides.
fn cross_error(files: &Files, axes: Axes) -> Option<Controller> {
    let tables = cec::CorrectionTables::read(files.get("_N_NC_CEC_INI")?)?;
    let count = axes.len();
    Some(Box::new(move |q, reverse| (0..count).map(|axis| -tables.sum(axis + 1, q, reverse, [true, true])).collect()))
}

/// HEIDENHAIN, MANUALplus 620 pp. 716, 718: a column for every corrected axis over the positions of one; straight
/// lines. Values are read as the error, the ends as held, an endless axis modulo: none of it is documented.
fn com(files: &Files, axes: Axes) -> Option<Controller> {
    /// Input, output, points.
    type Column = (usize, usize, Vec<(f64, f64)>);
    let mut columns: Vec<Column> = Vec::new();
    for (name, text) in files.iter().filter(|(name, _)| name.ends_with("_AXIS.COM")) {
        let input = at(axes, name.chars().next()?)?;
        let framed = |line: &&str| !line.starts_with([';', 'B', '[']);
        let mut rows = text.lines().filter(framed).map(|line| line.split(' ').collect::<Vec<_>>());
        let names = rows.next()?;
        let first = columns.len();
        for letter in names.strip_prefix(&["NR", "AXISPOS"][..])? {
            columns.push((input, at(axes, letter.chars().next()?)?, Vec::new()));
        }
        for row in rows {
            let q = real(row.get(1)?)?;
            (row.len() == names.len()).then_some(())?;
            for (column, cell) in columns[first..].iter_mut().zip(&row[2..]) {
                column.2.push((q, real(cell)?));
            }
        }
    }
    let endless: Vec<bool> = axes.iter().map(|(_, endless)| *endless).collect();
    Some(Box::new(move |q, _| {
        let mut added = vec![0.0; endless.len()];
        for (input, output, points) in &columns {
            let q = if endless[*input] { points[0].0 + (q[*input] - points[0].0).rem_euclid(360.0) } else { q[*input] };
            added[*output] -= between(points, q);
        }
        added
    }))
}

/// Straight lines between points anywhere, held at the ends.
pub fn between(points: &[(f64, f64)], q: f64) -> f64 {
    match points.iter().position(|(p, _)| *p > q) {
        Some(0) => points[0].1,
        None => points[points.len() - 1].1,
        Some(i) => {
            let ([p, a], [r, b]) = ([points[i - 1].0, points[i - 1].1], [points[i].0, points[i].1]);
            (a * (r - q) + b * (q - p)) / (r - p)
        }
    }
}

/// FANUC B-63980EN p. 100: whole increments between neighbouring points, zero at the reference point, summed up; lines
/// between points ("interpolated pitch error compensation"). Detection unit 1 um and 0.001 deg. With 3605#0 there are as
/// many points again for travel in the negative direction, from 3626 on, 3627 at the reference point.
fn pitch(files: &Files, axes: Axes) -> Option<Controller> {
    let mut tables: BTreeMap<usize, [Points; 2]> = BTreeMap::new();
    for (name, text) in files.iter().filter(|(name, _)| name.starts_with("PITCH_")) {
        let axis = at(axes, name.chars().nth(6)?)?;
        let mut parameters: BTreeMap<i64, i64> = BTreeMap::new();
        let (mut increments, mut interval): (BTreeMap<i64, i64>, f64) = (BTreeMap::new(), 0.0);
        for line in text.lines().filter(|line| line.starts_with('N')) {
            let parts = pieces(line, "NQAPM");
            let number: i64 = parts.first()?.parse().ok()?;
            match (number, &parts[..]) {
                (3624, [_, _, _, value]) => interval = real(value)?,
                (3625, [_, _, _, turn]) => (real(turn)? == 360.0).then_some(())?,
                (3600..3700, [_, _, _, value]) => drop(parameters.insert(number, value.parse().ok()?)),
                (10_000.., [_, "0", value]) => drop(increments.insert(number - 10_000, value.parse().ok()?)),
                _ => return None,
            }
        }
        let of = |number: i64| parameters.get(&number).copied();
        let (reference, first, last, times) = (of(3620)?, of(3621)?, of(3622)?, of(3623)?);
        let way = |number: i64, at_reference: i64| {
            let mut sums = vec![0_i64];
            for n in number..=number + last - first {
                sums.push(sums[sums.len() - 1] + increments.get(&n)? * times);
            }
            let zero = sums[usize::try_from(reference - first + 1).ok()?];
            let values = sums.iter().map(|sum| (sum - zero + at_reference) as f64 / 1000.0).collect();
            let start = (first - 1 - reference) as f64 * interval;
            Some(Points { start, step: interval, values, turn: axes[axis].1.then_some(360.0) })
        };
        let reverse = if of(3605)? == 1 { way(of(3626)?, of(3627)?)? } else { way(first, 0)? };
        tables.insert(axis, [way(first, 0)?, reverse]);
    }
    let count = axes.len();
    Some(Box::new(move |q, reverse| {
        let mut added = vec![0.0; count];
        tables.iter().for_each(|(axis, ways)| added[*axis] += ways[usize::from(reverse)].read(q[*axis]));
        added
    }))
}

/// FANUC A-79351E p. 3/13: fractions of the cell between 0 and 1, eight corners. Whole um.
fn lattice_of_points(files: &Files, axes: Axes) -> Option<Controller> {
    let text = files.get("lattice.txt")?;
    let row = |begin: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(begin))?;
        let numbers: Vec<f64> = line.split(' ').map(real).collect::<Option<_>>()?;
        <[f64; 3]>::try_from(numbers).ok()
    };
    let (counts, start, step) = (row("POINTS ")?.map(|n| n as usize), row("START ")?, row("INTERVAL ")?);
    // 10809.
    let times =
        text.lines().find_map(|line| line.strip_prefix("MAGNIFICATION ")).map_or(Some(1), |n| n.parse().ok())?;
    let mut nodes: BTreeMap<[usize; 3], [f64; 3]> = BTreeMap::new();
    for line in text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())) {
        let numbers: Vec<i64> = line.split(' ').map(|n| n.parse().ok()).collect::<Option<_>>()?;
        let [i, j, k, x, y, z] = numbers[..] else { return None };
        nodes.insert([i, j, k].map(|n| n as usize), [x, y, z].map(|n| (n * times) as f64));
    }
    (nodes.len() == counts.iter().product::<usize>()).then_some(())?;
    let [x, y, z] = [at(axes, 'X')?, at(axes, 'Y')?, at(axes, 'Z')?];
    let count = axes.len();
    Some(Box::new(move |q, _| {
        let place = [q[x], q[y], q[z]];
        let cell: [(usize, f64); 3] = std::array::from_fn(|k| {
            let cells = ((place[k] - start[k]) / step[k]).clamp(0.0, (counts[k] - 1) as f64);
            let low = (cells as usize).min(counts[k].saturating_sub(2));
            (low, cells - low as f64)
        });
        let mut added = vec![0.0; count];
        for corner in 0..8_usize {
            let bit = |k: usize| corner >> k & 1;
            let weight: f64 = (0..3).map(|k| if bit(k) == 1 { cell[k].1 } else { 1.0 - cell[k].1 }).product();
            let node = std::array::from_fn(|k| (cell[k].0 + bit(k)).min(counts[k] - 1));
            [x, y, z].iter().zip(nodes[&node]).for_each(|(axis, um)| added[*axis] += weight * um / 1000.0);
        }
        added
    }))
}

/// Beckhoff TF5200: whole 0.1 um and 0.0001 deg. Leadscrew lists hold the error (308693899), forward and reverse; cross and plane
/// lists a correction; end values hold (15327297547, 308713099), four-point interpolation on planes.
fn value_lists(files: &Files, axes: Axes) -> Option<Controller> {
    struct Plane {
        masters: [usize; 2],
        start: [f64; 2],
        step: f64,
        rows: Vec<Vec<f64>>,
    }
    let (mut own, mut cross, mut planes) = (Vec::new(), Vec::new(), Vec::new());
    for text in files.iter().filter(|(name, _)| name.starts_with("achskw_")).map(|(_, text)| text) {
        let lines = text.lines().filter(|line| !line.starts_with('#'));
        let said: BTreeMap<&str, &str> = lines.filter_map(|line| line.split_once(' ')).collect();
        let of = |name: &str| real(said.get(name)?);
        let axis = of("kopf.achs_nr")? as usize - 1;
        if let Some(count) = of("kw.ssfk.kw_nr_max") {
            let column = |way: &str| {
                let value = |i: usize| of(&format!("kw.ssfk.table[{i}].{way}"));
                (0..count as usize).map(value).collect::<Option<Vec<f64>>>()
            };
            let forward = column("pos")?;
            let reverse = if of("kw.ssfk.bilateral")? == 1.0 { column("neg")? } else { forward.clone() };
            let turn = (of("kw.ssfk.modulo")? == 1.0).then_some(3_600_000.0);
            let (start, step) = (of("kw.ssfk.kw_startpos")?, of("kw.ssfk.interval")?);
            own.push((axis, [forward, reverse].map(|values| Points { start, step, values, turn })));
        }
        if let Some(last) = of("kw.crosscomp.last_index") {
            let point = |i: usize| {
                let of = |name: &str| of(&format!("kw.crosscomp.table[{i}].{name}"));
                Some((of("setpoint")?, of("correction")?))
            };
            let points: Vec<(f64, f64)> = (0..=last as usize).map(point).collect::<Option<_>>()?;
            cross.push((of("kw.crosscomp.master_ax_nr")? as usize - 1, axis, points));
        }
        if let Some(width) = of("kw.crosscomp2.last_index_master1") {
            let value = |j: usize, i: usize| of(&format!("kw.crosscomp2.table[{j}][{i}].correction"));
            let height = of("kw.crosscomp2.last_index_master2")? as usize;
            let row = |j: usize| (0..=width as usize).map(|i| value(j, i)).collect::<Option<Vec<f64>>>();
            let rows = (0..=height).map(row).collect::<Option<_>>()?;
            let masters = [of("kw.crosscomp2.master1_ax_nr")?, of("kw.crosscomp2.master2_ax_nr")?];
            let start = [of("kw.crosscomp2.start_position_master1")?, of("kw.crosscomp2.start_position_master2")?];
            let plane =
                Plane { masters: masters.map(|n| n as usize - 1), start, step: of("kw.crosscomp2.interval")?, rows };
            planes.push((axis, plane));
        }
    }
    let endless: Vec<bool> = axes.iter().map(|(_, endless)| *endless).collect();
    Some(Box::new(move |q, reverse| {
        const UNIT: f64 = 1e4;
        let mut added = vec![0.0; endless.len()];
        own.iter().for_each(|(axis, ways)| added[*axis] -= ways[usize::from(reverse)].read(q[*axis] * UNIT) / UNIT);
        for (input, output, points) in &cross {
            let mut position = q[*input] * UNIT;
            if endless[*input] {
                position = points[0].0 + (position - points[0].0).rem_euclid(360.0 * UNIT);
            }
            added[*output] += between(points, position) / UNIT;
        }
        for (output, plane) in &planes {
            let along = |k: usize, values: Vec<f64>| {
                Points { start: plane.start[k], step: plane.step, values, turn: None }.read(q[plane.masters[k]] * UNIT)
            };
            let row: Vec<f64> = plane.rows.iter().map(|row| along(0, row.clone())).collect();
            added[*output] += along(1, row) / UNIT;
        }
        added
    }))
}

/// A buffer of PMAC: motors it is looked up over (index, spacings, length), entries with the origin's before them.
struct Buffer {
    over: Vec<(usize, usize, f64)>,
    motor: usize,
    entries: Vec<i64>,
}

impl Buffer {
    const COUNTS: f64 = 10_000.0;

    /// `SPACINGS,#MOTOR,LENGTH` or `ROWS.COLUMNS,#ALONG A ROW,#ALONG A COLUMN,#MOTOR,LENGTH OF A ROW,OF A COLUMN`.
    fn defined(parts: &[&str]) -> Option<Self> {
        let motor = |text: &str| Some(text.parse::<usize>().ok()? - 1);
        let (over, corrected) = match *parts {
            [count, source, target, length] => {
                (vec![(motor(source)?, count.parse().ok()?, real(length)?)], motor(target)?)
            }
            [counts, along, across, target, length, width] => {
                let (rows, columns) = counts.split_once('.')?;
                let row = (motor(along)?, columns.parse().ok()?, real(length)?);
                (vec![row, (motor(across)?, rows.parse().ok()?, real(width)?)], motor(target)?)
            }
            _ => return None,
        };
        Some(Self { over, motor: corrected, entries: vec![0] })
    }

    /// The last entry is that of the origin; lines and columns end as they begin.
    fn is_whole(&self) -> bool {
        let wide = self.over[0].1 + 1;
        let high = self.over.get(1).map_or(1, |(_, rows, _)| rows + 1);
        self.entries.len() == wide * high
            && self.entries.chunks(wide).all(|row| row[0] == row[wide - 1])
            && (high == 1 || self.entries[..wide] == self.entries[wide * (high - 1)..])
    }

    /// mm or deg: an entry is a sixteenth of a count.
    fn read(&self, q: &[f64]) -> f64 {
        let cell = |(motor, count, length): &(usize, usize, f64)| {
            let spacings = (q[*motor] * Self::COUNTS).rem_euclid(*length) / (length / *count as f64);
            let low = (spacings as usize).min(count - 1);
            (low, spacings - low as f64)
        };
        let (i, along) = cell(&self.over[0]);
        let (wide, (j, across)) = (self.over[0].1 + 1, self.over.get(1).map_or((0, 0.0), cell));
        let row = |j: usize| {
            let [a, b] = [i, i + 1].map(|i| self.entries[j * wide + i] as f64);
            a + (b - a) * along
        };
        let value = if across > 0.0 { row(j) + (row(j + 1) - row(j)) * across } else { row(j) };
        value / 16.0 / Self::COUNTS
    }
}

/// Turbo PMAC Software Reference pp. 301-305: entries of 1/16 count from one spacing on, the last one that of zero; the source's
/// position rolls over; first-order interpolation; all tables on a motor add up. 10000 counts per mm and deg. Moving in
/// the negative direction a motor is given its backlash table and Ixx86 less (p. 301).
fn leadscrew(files: &Files, axes: Axes) -> Option<Controller> {
    let [mut tables, mut backlash]: [Vec<Buffer>; 2] = Default::default();
    let mut constants: BTreeMap<usize, f64> = BTreeMap::new();
    let mut last_is_backlash = false;
    for line in files.get("compensation.pmc")?.lines().map(|line| line.split(';').next().unwrap_or("").trim()) {
        if let Some((_, rest)) = line.split_once(" DEFINE COMP ") {
            tables.push(Buffer::defined(&pieces(rest, "#D,"))?);
            last_is_backlash = false;
        } else if let Some((motor, rest)) = line.split_once(" DEFINE BLCOMP ") {
            let (motor, (count, length)) = (motor.strip_prefix('#')?, rest.split_once(',')?);
            backlash.push(Buffer::defined(&[count, motor, motor, length])?);
            last_is_backlash = true;
        } else if line.starts_with(|c: char| c.is_ascii_digit() || c == '-') {
            let entries: Option<Vec<i64>> = line.split_whitespace().map(|entry| entry.parse().ok()).collect();
            let list = if last_is_backlash { &mut backlash } else { &mut tables };
            list.last_mut()?.entries.extend(entries?);
        } else if let Some((motor, value)) = line.strip_prefix('I').and_then(|line| line.split_once("86=")) {
            constants.insert(motor.parse::<usize>().ok()? - 1, real(value)? / 16.0 / Buffer::COUNTS);
        }
    }
    tables.iter().chain(&backlash).all(Buffer::is_whole).then_some(())?;
    let count = axes.len();
    Some(Box::new(move |q, reverse| {
        let mut added = vec![0.0; count];
        tables.iter().for_each(|table| added[table.motor] += table.read(q));
        if reverse {
            backlash.iter().for_each(|table| added[table.motor] -= table.read(q));
            constants.iter().for_each(|(motor, lost)| added[*motor] -= lost);
        }
        added
    }))
}

/// KMotionX, Kinematics.cpp, GeoCorrect: the cell is that of the position, or the outermost; both weights may leave 0..1.
fn geo(files: &Files, axes: Axes) -> Option<Controller> {
    let mut lines = files.get("geo.txt")?.lines();
    let mut row = || lines.next()?.split(',').map(real).collect::<Option<Vec<f64>>>();
    let ([rows, columns], [dx, dy], [x0, y0]) = (pair(row()?)?, pair(row()?)?, pair(row()?)?);
    let (rows, columns) = (rows as usize, columns as usize);
    let mut table = vec![[f64::NAN; 3]; rows * columns];
    while let Some(cells) = row() {
        let [r, c, x, y, z] = cells[..] else { return None };
        *table.get_mut(r as usize * columns + c as usize)? = [x, y, z];
    }
    table.iter().flatten().all(|value| value.is_finite()).then_some(())?;
    let [x, y, z] = [at(axes, 'X')?, at(axes, 'Y')?, at(axes, 'Z')?];
    let count = axes.len();
    Some(Box::new(move |q, _| {
        let (px, py) = ((q[x] - x0) / dx, (q[y] - y0) / dy);
        let column = (px.floor().max(0.0) as usize).min(columns - 2);
        let row = (py.floor().max(0.0) as usize).min(rows - 2);
        let (fx, fy) = (px - column as f64, py - row as f64);
        let value = |k: usize| {
            let corner = |r: usize, c: usize| table[(row + r) * columns + column + c][k];
            let low = corner(0, 0) + fx * (corner(0, 1) - corner(0, 0));
            let high = corner(1, 0) + fx * (corner(1, 1) - corner(1, 0));
            low + fy * (high - low)
        };
        let mut added = vec![0.0; count];
        added[x] = value(0) - q[x];
        added[y] = value(1) - q[y];
        added[z] = value(2);
        added
    }))
}

fn pair(numbers: Vec<f64>) -> Option<[f64; 2]> {
    numbers.try_into().ok()
}

/// RepRapFirmware, Move.cpp AxisTransform and Grid.cpp: tangents of 1/1000 with S1000; the height by four points, held outside.
fn duet(files: &Files, axes: Axes) -> Option<Controller> {
    let tangent = |axis: char| {
        let begin = format!("M556 S1000 {axis}");
        let line = files.get("axis_compensation.g")?.lines().find_map(|line| line.strip_prefix(&*begin))?;
        Some(real(line)? / 1000.0)
    };
    let (xy, yz, xz) = (tangent('X')?, tangent('Y')?, tangent('Z')?);
    let map = match files.get("heightmap.csv") {
        None => None,
        Some(text) => {
            let lines: Vec<&str> = text.lines().collect();
            let head: Vec<f64> = lines.get(2)?.split(',').skip(2).map(real).collect::<Option<_>>()?;
            let [x0, _, y0, _, _, dx, dy, columns, rows] = head[..] else { return None };
            let heights: Vec<Vec<f64>> = lines[3..]
                .iter()
                .map(|line| line.split(',').map(real).collect::<Option<_>>())
                .collect::<Option<_>>()?;
            let whole = heights.len() == rows as usize && heights.iter().all(|row| row.len() == columns as usize);
            whole.then_some(())?;
            Some(([x0, y0], [dx, dy], heights))
        }
    };
    let [x, y, z] = [at(axes, 'X')?, at(axes, 'Y')?, at(axes, 'Z')?];
    let count = axes.len();
    // Move.cpp, AxisAndBedTransform: the bed is looked up where the axes have been moved to.
    Some(Box::new(move |q, _| {
        let mut added = vec![0.0; count];
        added[x] = xy * q[y] + xz * q[z];
        added[y] = yz * q[z];
        if let Some((start, step, heights)) = &map {
            let line =
                |start: f64, step: f64, values: Vec<f64>, q: f64| Points { start, step, values, turn: None }.read(q);
            let column: Vec<f64> =
                heights.iter().map(|row| line(start[0], step[0], row.clone(), q[x] + added[x])).collect();
            added[z] = line(start[1], step[1], column, q[y] + added[y]);
        }
        added
    }))
}

/// skew_correction.py and planner.h skew(): x' = x - y xy - z (xz - xy yz), y' = y - z yz.
fn skew(files: &Files, axes: Axes, begins: [&str; 3]) -> Option<Controller> {
    let text = files.iter().find(|(name, _)| name.starts_with("skew"))?.1;
    let factor = |begin: &str| real(text.lines().find_map(|line| line.strip_prefix(begin))?);
    let (xy, xz, yz) = (factor(begins[0])?, factor(begins[1])?, factor(begins[2])?);
    let [x, y, z] = [at(axes, 'X')?, at(axes, 'Y')?, at(axes, 'Z')?];
    let count = axes.len();
    Some(Box::new(move |q, _| {
        let mut added = vec![0.0; count];
        added[x] = -q[y] * xy - q[z] * (xz - xy * yz);
        added[y] = -q[z] * yz;
        added
    }))
}

/// Grbl counts settings.steps_per_mm times the target as steps (motion to `$100`), of which the machine needs those that
/// were in force for one mm: they stand in the comments that take them back.
fn steps(files: &Files, axes: Axes) -> Option<Controller> {
    let text = files.get("settings.nc")?;
    let number = |begin: &str| real(text.lines().find_map(|line| line.strip_prefix(begin))?);
    let mut ratios = vec![1.0; axes.len()];
    for (letter, setting) in [('X', 100), ('Y', 101), ('Z', 102)] {
        // A line only where the scale is wrong.
        if let Some(now) = number(&format!("${setting}=")) {
            ratios[at(axes, letter)?] = now / number(&format!("; ${setting}="))?;
        }
    }
    Some(Box::new(move |q, _| q.iter().zip(&ratios).map(|(q, ratio)| q * (ratio - 1.0)).collect()))
}

/// TF5280 296429067: blocks of named columns, linear on the grid.
fn volcomp(text: &str, axes: Axes, machine: &Sample) -> Option<Controller> {
    let mut errors = stacking::Errors::default();
    for block in text.split("\n#") {
        let mut lines = block.lines().filter(|line| !line.starts_with("//") && !line.trim().is_empty());
        let Some(names) = lines.next().map(|line| line.split_whitespace().collect::<Vec<_>>()) else { continue };
        let rows: Vec<Vec<f64>> =
            lines.map(|line| line.split_whitespace().map(real).collect::<Option<_>>()).collect::<Option<_>>()?;
        rows.iter().all(|row| row.len() == names.len()).then_some(())?;
        let argument = names[0].len() == 1;
        if !argument && names[0].starts_with('N') {
            continue;
        }
        for (column, name) in names.iter().enumerate().skip(usize::from(argument)) {
            let points = rows.iter().map(|row| (if argument { row[0] } else { 0.0 }, row[column])).collect();
            errors.put(name.trim_start_matches('E'), points)?;
        }
    }
    stacking::controller(errors, axes, machine)
}

/// TF5280 296430091: a block for each error.
fn etalon(text: &str, axes: Axes, machine: &Sample) -> Option<Controller> {
    let mut errors = stacking::Errors::default();
    let blocks = text.split('[').skip(1);
    for block in blocks {
        let (name, rest) = block.split_once(']')?;
        let mut points = Vec::new();
        for line in rest.lines().map(|line| line.split("//").next().unwrap_or("").trim()) {
            if let Some(value) = line.strip_prefix("VALUE = ") {
                points.push((0.0, real(value)?));
            } else if !line.is_empty() && line != "Gridpoints = {" && line != "}" {
                let (q, value) = line.split_once(' ')?;
                points.push((real(q)?, real(value)?));
            }
        }
        errors.put(name.trim_start_matches('E'), points)?;
    }
    stacking::controller(errors, axes, machine)
}

/// docs/controls/lattice.md: added to the command, multilinear, held outside, whole turns of an endless axis modulo.
fn json(text: &str, axes: Axes) -> Option<Controller> {
    let grid: serde_json::Value = serde_json::from_str(text).ok()?;
    let columns: Vec<&str> = grid["columns"].as_array()?.iter().map(|c| c.as_str()).collect::<Option<_>>()?;
    let rows: Vec<Vec<f64>> = grid["rows"]
        .as_array()?
        .iter()
        .map(|row| row.as_array()?.iter().map(serde_json::Value::as_f64).collect::<Option<_>>())
        .collect::<Option<_>>()?;
    let inputs: Vec<usize> =
        columns.iter().filter(|c| !c.starts_with('d')).map(|c| at(axes, c.chars().next()?)).collect::<Option<_>>()?;
    let outputs: Vec<usize> =
        columns[inputs.len()..].iter().map(|c| at(axes, c.chars().nth(1)?)).collect::<Option<_>>()?;
    let endless: Vec<bool> = inputs.iter().map(|axis| axes[*axis].1).collect();
    let (count, width) = (axes.len(), inputs.len());
    Some(Box::new(move |q, _| {
        let place: Vec<f64> = inputs
            .iter()
            .enumerate()
            .map(|(k, axis)| if endless[k] { rows[0][k] + (q[*axis] - rows[0][k]).rem_euclid(360.0) } else { q[*axis] })
            .collect();
        let mut added = vec![0.0; count];
        outputs.iter().enumerate().for_each(|(c, axis)| added[*axis] = multilinear(&rows, &place, 0, width + c));
        added
    }))
}

/// The value of a column at a place: the rows below and above in one axis, then in the next.
fn multilinear(rows: &[Vec<f64>], place: &[f64], axis: usize, column: usize) -> f64 {
    let Some(q) = place.get(axis) else { return rows[0][column] };
    let mut nodes: Vec<f64> = rows.iter().map(|row| row[axis]).collect();
    nodes.dedup();
    let value = |node: f64| {
        let held: Vec<Vec<f64>> = rows.iter().filter(|row| row[axis] == node).cloned().collect();
        multilinear(&held, place, axis + 1, column)
    };
    let high = nodes.iter().position(|node| node > q);
    match high {
        Some(0) => value(nodes[0]),
        None => value(nodes[nodes.len() - 1]),
        Some(i) => between(&[(nodes[i - 1], value(nodes[i - 1])), (nodes[i], value(nodes[i]))], *q),
    }
}
