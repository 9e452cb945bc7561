// SPDX-License-Identifier: GPL-3.0-or-later
#include <unistd.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <cerrno>
#include <ext/stdio_filebuf.h>
#include <ostream>
#include <type_traits>

#include "kernel/vtk/vtk_library.hpp"
#include "kernel/vtk/xml_attribute.hpp"

namespace suture {
namespace {

// An open file that remembers why it could not be written: VTK knows only that.
class RecordingBuffer : public __gnu_cxx::stdio_filebuf<char> {
  using Base = __gnu_cxx::stdio_filebuf<char>;

 public:
  explicit RecordingBuffer(int file)
      : Base(file, std::ios::out | std::ios::binary, std::size_t{1} << 18) {}
  int error() const { return error_; }
  void record() {
    if (error_ == 0) error_ = errno != 0 ? errno : EIO;
  }

 protected:
  std::streamsize xsputn(const char* data, std::streamsize n) override {
    errno = 0;
    const std::streamsize written = Base::xsputn(data, n);
    if (written != n) record();
    return written;
  }
  int_type overflow(int_type c) override {
    errno = 0;
    const int_type result = Base::overflow(c);
    if (traits_type::eq_int_type(result, traits_type::eof())) record();
    return result;
  }
  pos_type seekoff(off_type offset, std::ios_base::seekdir way,
                   std::ios_base::openmode mode) override {
    errno = 0;
    const pos_type result = Base::seekoff(offset, way, mode);
    if (result == pos_type(off_type(-1))) record();
    return result;
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode mode) override {
    errno = 0;
    const pos_type result = Base::seekpos(position, mode);
    if (result == pos_type(off_type(-1))) record();
    return result;
  }
  int sync() override {
    errno = 0;
    const int result = Base::sync();
    if (result != 0) record();
    return result;
  }

 private:
  int error_ = 0;
};

// VTK's writer offers no way to give it a stream, but keeps the one that it opens, here of
// a text, in a member: it is exchanged before the first byte is written.
template <class Base>
class StreamWriter : public Base {
 public:
  static StreamWriter* New() { return new StreamWriter; }
  void write_to(std::ostream* stream) { stream_ = stream; }

 protected:
  StreamWriter() { this->InitializeObjectBase(); }
  int StartFile() override {
    this->Stream = stream_;
    this->Stream->imbue(std::locale::classic());
    return Base::StartFile();
  }

 private:
  std::ostream* stream_ = nullptr;
};

// `data` still belongs to the caller: VTK must not free it.
template <class Array, class T>
vtkSmartPointer<Array> borrowed(const T* data, std::size_t tuples, int components) {
  auto array = vtkSmartPointer<Array>::New();
  array->SetNumberOfComponents(components);
  using Value = typename Array::ValueType;
  static_assert(sizeof(Value) == sizeof(T));
  // VTK knows no arrays of constants; a writer does not write to them.
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast)
  auto* values = const_cast<Value*>(reinterpret_cast<const Value*>(data));
  array->SetArray(values, static_cast<vtkIdType>(tuples) * components, 1);
  return array;
}

vtkSmartPointer<vtkDataArray> array_of(const VtuArray& source, std::size_t tuples) {
  vtkSmartPointer<vtkDataArray> array;
  if (source.values) array = borrowed<vtkDoubleArray>(source.values, tuples, source.components);
  if (source.ids) array = borrowed<vtkTypeInt64Array>(source.ids, tuples, source.components);
  if (source.flags) array = borrowed<vtkUnsignedCharArray>(source.flags, tuples, source.components);
  if (!array) array = vtkSmartPointer<vtkDoubleArray>::New();
  // VTK 9.1 writes names into XML attributes as they are.
  array->SetName(in_attribute(source.name).c_str());
  for (std::size_t c = 0; c < source.component_names.size(); ++c)
    array->SetComponentName(static_cast<vtkIdType>(c), source.component_names[c]);
  return array;
}

void add_arrays(vtkDataSetAttributes* data, const std::vector<VtuArray>& sources,
                std::size_t tuples) {
  for (const VtuArray& source : sources) {
    const auto array = array_of(source, tuples);
    if (source.global_ids)
      data->SetGlobalIds(array);
    else
      data->AddArray(array);
  }
}

template <class Grid>
void set_cells(Grid* grid, vtkCellArray* cells, vtkUnsignedCharArray* types) {
  if constexpr (std::is_same_v<Grid, vtkPolyData>)
    grid->SetPolys(cells);
  else
    grid->SetCells(types, cells);
}

template <class Grid>
vtkSmartPointer<Grid> grid_of(const VtuImage& image) {
  auto grid = vtkSmartPointer<Grid>::New();
  const vtkNew<vtkPoints> points;
  points->SetData(borrowed<vtkDoubleArray>(image.points->data(), image.point_count, 3));
  grid->SetPoints(points);

  const vtkIdType n = static_cast<vtkIdType>(image.cell_count);
  const vtkNew<vtkTypeInt32Array> offsets;
  offsets->SetNumberOfValues(n + 1);
  offsets->SetValue(0, 0);
  const vtkNew<vtkUnsignedCharArray> types;
  types->SetNumberOfValues(n);
  for (vtkIdType c = 0; c < n; ++c) {
    const VtuCell type = image.cell_types.empty() ? VtuCell::hexahedron
                                                  : image.cell_types[static_cast<std::size_t>(c)];
    offsets->SetValue(c + 1, offsets->GetValue(c) + points_of(type));
    types->SetValue(c, static_cast<unsigned char>(type));
  }
  const vtkNew<vtkCellArray> cells;
  cells->SetData(offsets,
                 borrowed<vtkTypeInt32Array>(image.connectivity, image.connectivity_size, 1));
  set_cells<Grid>(grid, cells, types);

  add_arrays(grid->GetPointData(), image.point_arrays, image.point_count);
  add_arrays(grid->GetCellData(), image.cell_arrays, image.cell_count);
  return grid;
}

void add_field_data(vtkDataObject* grid, const VtuImage& image) {
  if (image.time) {
    const vtkNew<vtkDoubleArray> time;
    time->SetName("TimeValue");
    time->InsertNextValue(*image.time);
    grid->GetFieldData()->AddArray(time);
  }
  if (!image.provenance.empty()) {
    const vtkNew<vtkStringArray> text;
    text->SetName("provenance");
    text->InsertNextValue(image.provenance);
    grid->GetFieldData()->AddArray(text);
  }
}

void set_compression(vtkXMLWriter* writer, VtuCompression compression) {
  switch (compression) {
    case VtuCompression::raw:
      writer->SetCompressorTypeToNone();
      break;
    case VtuCompression::lz4:
      writer->SetCompressorTypeToLZ4();
      break;
    case VtuCompression::lzma:
      writer->SetCompressorTypeToLZMA();
      break;
    case VtuCompression::zlib:
      writer->SetCompressorTypeToZLib();
      break;
  }
}

template <class Grid, class Writer>
VtuOutcome write_grid(int descriptor, const VtuImage& image) {
  const VtkMessages messages;
  RecordingBuffer file(::dup(descriptor));
  if (!file.is_open()) return {errno, {}};
  std::ostream stream(&file);

  const auto grid = grid_of<Grid>(image);
  add_field_data(grid, image);
  const vtkNew<StreamWriter<Writer>> writer;
  writer->write_to(&stream);
  writer->WriteToOutputStringOn();
  writer->SetInputData(grid);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetHeaderTypeToUInt64();
  set_compression(writer, image.compression);
  const bool written = writer->Write() == 1;
  errno = 0;
  if (!file.close()) file.record();
  if (file.error() != 0) return {file.error(), {}};
  if (!written || !messages.first().empty()) {
    return {0, messages.first().empty() ? "VTK reported no reason" : messages.first()};
  }
  return {};
}

}  // namespace

VtuOutcome write_vtu_file(int descriptor, const VtuImage& image) {
  return image.is_surface
             ? write_grid<vtkPolyData, vtkXMLPolyDataWriter>(descriptor, image)
             : write_grid<vtkUnstructuredGrid, vtkXMLUnstructuredGridWriter>(descriptor, image);
}

}  // namespace suture
