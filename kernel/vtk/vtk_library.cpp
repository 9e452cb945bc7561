// SPDX-License-Identifier: GPL-3.0-or-later
//
// The module itself: the factory, and the window into which VTK reports.
#include "kernel/vtk/vtk_library.hpp"

#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>

namespace suture {
namespace {

thread_local VtkMessages* current_messages = nullptr;

// VTK prints what it has to say; here it goes to whoever called.
class MessageWindow : public vtkOutputWindow {
 public:
  static MessageWindow* New();
  vtkTypeMacro(MessageWindow, vtkOutputWindow)
  void DisplayText(const char* text) override { VtkMessages::add(text); }
  void DisplayErrorText(const char* text) override { VtkMessages::add(text); }
  void DisplayWarningText(const char* text) override { VtkMessages::add(text); }
  void DisplayGenericWarningText(const char* text) override { VtkMessages::add(text); }
  void DisplayDebugText(const char*) override {}
};
vtkStandardNewMacro(MessageWindow)

class Library final : public VtkModule {
 public:
  Library() {
    const vtkNew<MessageWindow> window;
    vtkOutputWindow::SetInstance(window);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  }
  bool expand(VtuCompression compression, std::span<const unsigned char> block,
              std::span<unsigned char> out) const override {
    return expand_block(compression, block, out);
  }
  VtuOutcome write_vtu(int file, const VtuImage& image) const override {
    return write_vtu_file(file, image);
  }
};

// "ERROR: In file.cxx, line 12\nvtkReader (0x55..): what\n\n" -> "what".
std::string core_of(const std::string& text) {
  const std::size_t object = text.find("): ");
  std::string core = object == text.npos ? text : text.substr(object + 3);
  while (!core.empty() && static_cast<unsigned char>(core.back()) <= ' ') core.pop_back();
  return core;
}

}  // namespace

VtkMessages::VtkMessages() : outer_(current_messages) { current_messages = this; }
VtkMessages::~VtkMessages() { current_messages = outer_; }

void VtkMessages::add(const char* text) {
  if (current_messages && current_messages->first_.empty() && text) {
    current_messages->first_ = core_of(text);
  }
}

}  // namespace suture

extern "C" __attribute__((visibility("default"))) const suture::VtkModule* suture_vtk_module_1() {
  static const suture::Library library;
  return &library;
}
