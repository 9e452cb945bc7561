// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/output/vtu_oracle.hpp"

#include <gtest/gtest.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>
#include <vtkXMLGenericDataObjectReader.h>

namespace suture {
namespace {

std::map<std::string, VtuContents::Array> arrays_of(vtkFieldData* data) {
  std::map<std::string, VtuContents::Array> arrays;
  for (int a = 0; a < data->GetNumberOfArrays(); ++a) {
    vtkDataArray* from = data->GetArray(a);
    if (!from) continue;
    VtuContents::Array& to = arrays[from->GetName()];
    to.components = from->GetNumberOfComponents();
    for (vtkIdType t = 0; t < from->GetNumberOfTuples(); ++t) {
      for (int c = 0; c < to.components; ++c) to.values.push_back(from->GetComponent(t, c));
    }
    for (int c = 0; from->HasAComponentName() && c < to.components; ++c) {
      to.component_names.emplace_back(from->GetComponentName(c));
    }
  }
  return arrays;
}

}  // namespace

VtuContents read_with_vtk(const std::filesystem::path& path) {
  const vtkNew<vtkXMLGenericDataObjectReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  EXPECT_EQ(reader->GetErrorCode(), 0u) << path;
  auto* grid = vtkDataSet::SafeDownCast(reader->GetOutput());
  if (grid == nullptr) return {};
  VtuContents contents;
  contents.points.resize(static_cast<std::size_t>(grid->GetNumberOfPoints()));
  for (std::size_t i = 0; i < contents.points.size(); ++i) {
    grid->GetPoint(static_cast<vtkIdType>(i), contents.points[i].data());
  }
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    contents.types.push_back(grid->GetCellType(c));
    vtkIdList* ids = grid->GetCell(c)->GetPointIds();
    auto& nodes = contents.cells.emplace_back();
    for (vtkIdType n = 0; n < ids->GetNumberOfIds(); ++n) nodes.push_back(ids->GetId(n));
  }
  contents.point_arrays = arrays_of(grid->GetPointData());
  contents.cell_arrays = arrays_of(grid->GetCellData());
  contents.field_arrays = arrays_of(grid->GetFieldData());
  if (auto* text =
          vtkStringArray::SafeDownCast(grid->GetFieldData()->GetAbstractArray("provenance"))) {
    contents.provenance = text->GetValue(0);
  }
  if (auto* ids = grid->GetPointData()->GetGlobalIds()) contents.global_point_ids = ids->GetName();
  return contents;
}

}  // namespace suture
