// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/mesh/vtk_files.hpp"

#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridReader.h>
#include <vtkUnstructuredGridWriter.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>
#include <vtkZLibDataCompressor.h>

#include "kernel/mesh/vtk_order.hpp"

namespace suture {
namespace {

vtkSmartPointer<vtkUnstructuredGrid> grid_of(const Mesh& mesh) {
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  const vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vec3& x : mesh.points) points->InsertNextPoint(x.data());
  grid->SetPoints(points);
  for (const Hexahedron& nodes : mesh.hexahedra) {
    vtkIdType ids[8];
    std::size_t n = 0;
    for (const Index node : swap_vtk_order(nodes)) ids[n++] = node;
    grid->InsertNextCell(VTK_HEXAHEDRON, 8, ids);
  }
  for (const auto& [name, members] : mesh.element_sets) {
    const vtkNew<vtkUnsignedCharArray> flags;
    flags->SetName(name.c_str());
    flags->SetNumberOfValues(static_cast<vtkIdType>(mesh.hexahedra.size()));
    flags->FillValue(0);
    for (const Index e : members) flags->SetValue(e, 1);
    grid->GetCellData()->AddArray(flags);
  }
  const vtkNew<vtkIdTypeArray> ids;
  ids->SetName("ids");
  for (const std::uint64_t id : mesh.point_ids) ids->InsertNextValue(static_cast<vtkIdType>(id));
  if (!mesh.point_ids.empty()) grid->GetPointData()->SetGlobalIds(ids);
  return grid;
}

void configure(vtkXMLWriter* writer, VtkEncoding encoding) {
  writer->SetCompressorTypeToNone();
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  if (encoding == VtkEncoding::text) writer->SetDataModeToAscii();
  if (encoding == VtkEncoding::inline_base64) writer->SetDataModeToBinary();
  if (encoding == VtkEncoding::appended_base64) writer->EncodeAppendedDataOn();
  if (encoding == VtkEncoding::lz4) writer->SetCompressorTypeToLZ4();
  if (encoding == VtkEncoding::zlib) writer->SetCompressorTypeToZLib();
  if (encoding == VtkEncoding::lzma) writer->SetCompressorTypeToLZMA();
}

Mesh mesh_of(vtkUnstructuredGrid* grid) {
  Mesh mesh;
  mesh.points.resize(static_cast<std::size_t>(grid->GetNumberOfPoints()));
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    grid->GetPoint(static_cast<vtkIdType>(i), mesh.points[i].data());
  }
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    Hexahedron nodes;
    for (int n = 0; n < 8; ++n) nodes[n] = static_cast<Index>(grid->GetCell(c)->GetPointId(n));
    mesh.hexahedra.push_back(swap_vtk_order(nodes));
  }
  const auto add_sets = [](vtkDataSetAttributes* data, auto& sets) {
    for (int a = 0; a < data->GetNumberOfArrays(); ++a) {
      auto* flags = vtkUnsignedCharArray::SafeDownCast(data->GetArray(a));
      for (vtkIdType i = 0; flags && i < flags->GetNumberOfValues(); ++i) {
        if (flags->GetValue(i) == 1) sets[flags->GetName()].push_back(static_cast<Index>(i));
      }
    }
  };
  add_sets(grid->GetPointData(), mesh.point_sets);
  add_sets(grid->GetCellData(), mesh.element_sets);
  return mesh;
}

}  // namespace

void write_with_vtk(const std::filesystem::path& path, const Mesh& mesh, VtkEncoding encoding) {
  const auto grid = grid_of(mesh);
  if (encoding == VtkEncoding::legacy_text || encoding == VtkEncoding::legacy_binary) {
    const vtkNew<vtkUnstructuredGridWriter> writer;
    if (encoding == VtkEncoding::legacy_binary) writer->SetFileTypeToBinary();
    writer->SetFileName(path.c_str());
    writer->SetInputData(grid);
    writer->Write();
    return;
  }
  const vtkNew<vtkXMLUnstructuredGridWriter> writer;
  configure(writer, encoding);
  writer->SetFileName(path.c_str());
  writer->SetInputData(grid);
  writer->Write();
}

std::string zlib_zeros(std::size_t bytes) {
  const vtkNew<vtkZLibDataCompressor> compressor;
  const std::vector<unsigned char> zeros(bytes);
  std::string packed(compressor->GetMaximumCompressionSpace(bytes), '\0');
  packed.resize(compressor->Compress(
      zeros.data(), bytes, reinterpret_cast<unsigned char*>(packed.data()), packed.size()));
  return packed;
}

Mesh read_mesh_with_vtk(const std::filesystem::path& path) {
  if (path.extension() == ".vtk") {
    const vtkNew<vtkUnstructuredGridReader> reader;
    reader->SetFileName(path.c_str());
    reader->ReadAllScalarsOn();
    reader->Update();
    return mesh_of(reader->GetOutput());
  }
  const vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  return mesh_of(reader->GetOutput());
}

}  // namespace suture
