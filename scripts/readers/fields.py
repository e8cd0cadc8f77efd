#!/usr/bin/env python3
"""Tells as JSON what VTK reads of the fields of a result, by every way into them.

python fields.py OUT.h5: for the result itself (through its link), OUT.vtkhdf and OUT.xdmf the times, and of every time the
grid's bounds, volume and number of points, and the least and largest value of each component of each field.
"""

import json
import sys
from pathlib import Path

import vtk
from vtk.util.numpy_support import vtk_to_numpy


def volume(grid):
    """Of all cells, cut into linear ones; of cells turned inside out it is negative."""
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    return float(vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume")).sum())


def blocks(data):
    """The grid itself, or the one in a collection."""
    while not isinstance(data, vtk.vtkUnstructuredGrid):
        data = data.GetBlock(0) if hasattr(data, "GetBlock") else data.GetPartition(0)
    return data


def told(reader):
    """What a reader tells of a file."""
    reader.UpdateInformation()
    information = reader.GetOutputInformation(0)
    times = information.Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or ()
    frames = []
    for time in times:
        reader.UpdateTimeStep(time)
        grid = blocks(reader.GetOutputDataObject(0))
        data = grid.GetPointData()
        values = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
        frames.append({
            "time": time,
            "points": grid.GetNumberOfPoints(),
            "cells": grid.GetNumberOfCells(),
            "cell_type": grid.GetCellType(0),
            "bounds": grid.GetBounds(),
            "volume": volume(grid),
            "least": {name: value.min(axis=0).tolist() for name, value in values.items()},
            "largest": {name: value.max(axis=0).tolist() for name, value in values.items()},
        })
    return frames


def main():
    result = Path(sys.argv[1])
    ways = {}
    for name, path, kind in [
        ("result", result, vtk.vtkHDFReader),
        ("vtkhdf", result.with_suffix(".vtkhdf"), vtk.vtkHDFReader),
        ("xdmf", result.with_suffix(".xdmf"), vtk.vtkXdmfReader),
    ]:
        reader = kind()
        reader.SetFileName(str(path))
        ways[name] = told(reader)
    json.dump(ways, sys.stdout)


main()
