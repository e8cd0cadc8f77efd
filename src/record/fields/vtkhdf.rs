//! VTKHDF 2.0: an unstructured grid, written once, with its fields at several times (docs.vtk.org, VTK file formats).

use std::path::Path;

use hdf5_metno as hdf5;
use hdf5_metno::types::FixedAscii;
use ndarray::ArrayView2;

use crate::element::Shape;
use crate::record::columns::{new_rows, put};
use crate::record::storage::{self, write_text};
use crate::space::evaluate::{Fields, Grid};

/// Number of frames in a chunk if the number of frames is not planned.
const CHUNK_UNPLANNED: usize = 32;

/// Largest number of rows (three numbers each) in a chunk; HDF5 allows 4 GiB.
const ROWS_MOST: usize = 1 << 27;

/// Name of the group that VTK readers look for.
pub const GROUP: &str = "VTKHDF";

/// Name, unit and values of a field.
type Field = (&'static str, &'static str, fn(&Fields) -> &[f64]);

/// All fields that are written.
pub const FIELDS: [Field; 3] = [
    ("displacement", "m", |frame| &frame.displacement),
    ("velocity", "m/s", |frame| &frame.velocity),
    ("principal_stress", "Pa", |frame| &frame.principal_stress),
];

/// Open VTKHDF file.
pub struct VtkHdf {
    file: hdf5::File,
    /// Datasets of the fields, in the order of [`FIELDS`].
    data: Vec<hdf5::Dataset>,
    /// Group `/VTKHDF/Steps`.
    steps: hdf5::Group,
    /// Shape of the cells.
    pub shape: Shape,
    /// Polynomial order of the elements.
    pub order: usize,
    /// Number of cells, and number of points of each cell.
    pub cells: [usize; 2],
    /// Number of points of the grid.
    pub points: usize,
    /// Time of each frame, s.
    pub times: Vec<f64>,
}

impl VtkHdf {
    /// Creates a file with the grid; `planned` is the number of frames if it is known.
    pub fn create(path: &Path, grid: &Grid, planned: Option<usize>) -> hdf5::Result<Self> {
        let file = storage::create(path)?;
        let root = file.create_group(GROUP)?;
        let version = root.new_attr::<i64>().shape(2).create("Version")?;
        version.write(&[2_i64, 0])?;
        // VTK readers expect a string of a fixed length.
        let name = FixedAscii::<16>::from_ascii(b"UnstructuredGrid").map_err(|e| e.to_string())?;
        root.new_attr::<FixedAscii<16>>().create("Type")?.write_scalar(&name)?;
        let (points, each) = (grid.points.len(), grid.points_each());
        let cells = grid.cells.len() / each;
        let whole = |name: &str, values: &[i64]| root.new_dataset_builder().with_data(values).create(name);
        let places = root.new_dataset_builder().with_data(ArrayView2::from(&grid.points[..])).create("Points")?;
        write_text(&places, "units", "m")?;
        whole("Connectivity", &grid.cells.iter().map(|point| *point as i64).collect::<Vec<_>>())?;
        whole("Offsets", &(0..=cells).map(|cell| (cell * each) as i64).collect::<Vec<_>>())?;
        root.new_dataset_builder().with_data(&vec![cell_type(grid.shape, grid.order); cells]).create("Types")?;
        for (name, count) in
            [("NumberOfPoints", points), ("NumberOfCells", cells), ("NumberOfConnectivityIds", grid.cells.len())]
        {
            whole(name, &[count as i64])?;
        }
        let frames = planned.unwrap_or(CHUNK_UNPLANNED).clamp(1, (ROWS_MOST / points).max(1));
        let group = root.create_group("PointData")?;
        let data = FIELDS.map(|(name, units, _)| new_rows::<f64>(&group, name, units, Some(3), frames * points));
        let data = data.into_iter().collect::<hdf5::Result<Vec<_>>>()?;
        let steps = root.create_group("Steps")?;
        steps.new_attr::<i64>().create("NSteps")?.write_scalar(&0_i64)?;
        new_rows::<f64>(&steps, "Values", "s", None, frames)?;
        for Offset { name, columns, .. } in offsets(0) {
            new_rows::<i64>(&steps, &name, "1", columns, frames)?;
        }
        let Grid { shape, order, .. } = *grid;
        Ok(Self { file, data, steps, shape, order, cells: [cells, each], points, times: Vec::new() })
    }

    /// Opens a file of the same grid to continue it after its frames up to the time `end`, s.
    pub fn reopen(path: &Path, grid: &Grid, end: f64) -> hdf5::Result<Self> {
        let file = storage::open_to_write(path)?;
        let root = file.group(GROUP)?;
        let (points, each) = (grid.points.len(), grid.points_each());
        let data = FIELDS.map(|(name, ..)| root.dataset(&format!("PointData/{name}")));
        let data = data.into_iter().collect::<hdf5::Result<Vec<_>>>()?;
        let steps = root.group("Steps")?;
        let mut times = storage::read::<f64>(&steps, "Values")?;
        // The relative tolerance allows for rounding of times that are computed as products.
        times.truncate(times.partition_point(|time| *time <= end * (1.0 + 1e-12)));
        if root.dataset("Points")?.shape() != [points, 3] || data[0].shape()[0] < times.len() * points {
            return Err("it is of another grid, or lacks frames".into());
        }
        // Later frames belong to the interrupted run and are removed.
        let frames = times.len();
        for dataset in &data {
            dataset.resize((frames * points, 3))?;
        }
        steps.dataset("Values")?.resize(frames)?;
        for offset in offsets(0) {
            offset.resize(&steps, frames)?;
        }
        steps.attr("NSteps")?.write_scalar(&(frames as i64))?;
        let Grid { shape, order, .. } = *grid;
        Ok(Self { file, data, steps, shape, order, cells: [grid.cells.len() / each, each], points, times })
    }

    /// Appends the frame at a time, s.
    pub fn append(&mut self, time: f64, frame: &Fields) -> hdf5::Result<()> {
        let (number, points) = (self.times.len(), self.points);
        let rows = number * points..(number + 1) * points;
        for (dataset, (_, _, values)) in self.data.iter().zip(FIELDS) {
            dataset.resize((rows.end, 3))?;
            let values = ArrayView2::from_shape((points, 3), values(frame)).map_err(|e| e.to_string())?;
            dataset.write_slice(values, (rows.clone(), ..))?;
        }
        for offset in offsets(rows.start) {
            let dataset = offset.resize(&self.steps, number + 1)?;
            match offset.columns {
                None => dataset.write_slice(&[offset.value], number..number + 1)?,
                Some(_) => dataset.write_slice(ArrayView2::from(&[[offset.value]]), (number..number + 1, ..))?,
            }
        }
        put(&self.steps.dataset("Values")?, number, &[time])?;
        self.times.push(time);
        Ok(())
    }

    /// Flushes the file. The number of frames is written after the frames, so that it never counts a missing frame.
    pub fn flush(&self) -> hdf5::Result<()> {
        self.file.flush()?;
        self.steps.attr("NSteps")?.write_scalar(&(self.times.len() as i64))?;
        self.file.flush()
    }
}

/// Dataset of integers below `/VTKHDF/Steps`, with its value for a frame.
struct Offset {
    name: String,
    columns: Option<usize>,
    value: i64,
}

impl Offset {
    fn resize(&self, steps: &hdf5::Group, frames: usize) -> hdf5::Result<hdf5::Dataset> {
        let dataset = steps.dataset(&self.name)?;
        self.columns.map_or_else(|| dataset.resize(frames), |columns| dataset.resize((frames, columns)))?;
        Ok(dataset)
    }
}

/// All such datasets, for a frame whose fields begin at the row `first`. The grid is the same in all frames.
fn offsets(first: usize) -> Vec<Offset> {
    let offset = |name: &str, columns, value| Offset { name: name.to_owned(), columns, value };
    let of_grid = [("PartOffsets", None, 0), ("NumberOfParts", None, 1), ("PointOffsets", None, 0)];
    let of_cells = ["CellOffsets", "ConnectivityIdOffsets"].map(|name| offset(name, Some(1), 0));
    let of_fields = FIELDS.map(|(name, ..)| offset(&format!("PointDataOffsets/{name}"), None, first as i64));
    of_grid
        .map(|(name, columns, value)| offset(name, columns, value))
        .into_iter()
        .chain(of_cells)
        .chain(of_fields)
        .collect()
}

/// Number of a cell type in VTK.
fn cell_type(shape: Shape, order: usize) -> u8 {
    match (shape, order) {
        (Shape::Tetrahedron, 1) => 10,
        (Shape::Tetrahedron, _) => 24,
        (_, 1) => 12,
        _ => 29,
    }
}
