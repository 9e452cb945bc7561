// SPDX-License-Identifier: GPL-3.0-or-later
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <exception>

#include "kernel/vtk/vtk_library.hpp"

namespace suture {
namespace {

std::vector<std::int64_t> integers_of(vtkDataArray* array) {
  const vtkIdType n = array ? array->GetNumberOfTuples() : 0;
  std::vector<std::int64_t> values(static_cast<std::size_t>(n));
  const bool is_float =
      array && (array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE);
  if (n == 0 || is_float) return values;
  switch (array->GetDataType()) {
    vtkTemplateMacro(
        std::copy_n(static_cast<const VTK_TT*>(array->GetVoidPointer(0)), n, values.begin()));
    default:
      break;
  }
  return values;
}

void add_labels(vtkDataSetAttributes* data, bool of_cells, VtkGrid& grid) {
  for (int a = 0; a < data->GetNumberOfArrays(); ++a) {
    vtkDataArray* array = data->GetArray(a);
    if (!array || array->GetNumberOfComponents() != 1 || !array->GetName()) continue;
    const int type = array->GetDataType();
    if (type == VTK_FLOAT || type == VTK_DOUBLE) continue;
    grid.labels.push_back({array->GetName(), of_cells, array->GetDataTypeSize() == 1,
                           array == data->GetGlobalIds(), integers_of(array)});
  }
}

void copy_points(vtkUnstructuredGrid* from, VtkGrid& grid) {
  const vtkIdType n = from->GetNumberOfPoints();
  grid.points.resize(static_cast<std::size_t>(n));
  for (vtkIdType i = 0; i < n; ++i) from->GetPoints()->GetPoint(i, grid.points[i].data());
}

std::string read(const std::string& path, VtkGrid& grid) {
  const VtkMessages messages;
  const vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  if (!messages.first().empty()) return messages.first();
  if (reader->GetErrorCode() != 0) return "VTK cannot read the file";
  vtkUnstructuredGrid* output = reader->GetOutput();
  copy_points(output, grid);
  vtkCellArray* cells = output->GetCells();
  if (cells && output->GetCellTypesArray()) {
    grid.offsets = integers_of(cells->GetOffsetsArray());
    grid.connectivity = integers_of(cells->GetConnectivityArray());
    const vtkUnsignedCharArray* types = output->GetCellTypesArray();
    grid.types.resize(static_cast<std::size_t>(types->GetNumberOfValues()));
    for (std::size_t c = 0; c < grid.types.size(); ++c)
      grid.types[c] = output->GetCellTypesArray()->GetValue(c);
  }
  add_labels(output->GetPointData(), false, grid);
  add_labels(output->GetCellData(), true, grid);
  return "";
}

}  // namespace

std::string read_vtu_file(const std::string& path, VtkGrid& grid) {
  try {
    return read(path, grid);
  } catch (const std::exception& error) {
    // VTK allocates what a damaged header asks for.
    return std::string("VTK cannot read the file (") + error.what() + "); a count in it is wrong";
  }
}

}  // namespace suture
