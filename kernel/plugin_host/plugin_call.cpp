// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/plugin_call.hpp"

#include <cxxabi.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

/// A loaded plugin. The list is never shortened, so that handlers can read it at any time.
struct Loaded {
  const suture_plugin* plugin;
  std::string file;
  const Loaded* next;
};
std::atomic<const Loaded*> all_loaded{nullptr};

bool within(const auto* item, const auto* first, std::uint32_t count) {
  const std::less_equal<> before;  // pointers into different arrays
  return item != nullptr && first != nullptr && before(first, item) && !before(first + count, item);
}

const suture_model* model_with(const suture_plugin& plugin, const PluginCall& call) {
  for (std::uint32_t i = 0; i < plugin.model_count; ++i) {
    const suture_model& model = plugin.models[i];
    if (&model == call.model || within(call.functor, model.functors, model.functor_count))
      return &model;
  }
  return nullptr;
}

/// Appends to a buffer, and leaves out what does not fit. No allocation.
class Text {
 public:
  Text(char* out, std::size_t size) : out_(out), room_(size - 1) {}
  Text& operator<<(const char* text) {
    while (*text != '\0' && used_ < room_) out_[used_++] = *text++;
    out_[used_] = '\0';
    return *this;
  }
  Text& operator<<(std::uint32_t number) {
    char digits[11] = {};
    char* first = digits + 10;
    do *--first = static_cast<char>('0' + number % 10);
    while ((number /= 10) != 0);
    return *this << first;
  }
  std::size_t size() const { return used_; }

 private:
  char* out_;
  std::size_t room_, used_ = 0;
};

void describe_plugin(const PluginCall& call, Text& text) {
  const suture_model* model = call.model;
  if (call.file != nullptr) text << "plugin " << call.file << ", ";
  for (const Loaded* at = all_loaded.load(); at != nullptr; at = at->next) {
    const suture_model* found = model_with(*at->plugin, call);
    if (found == nullptr) continue;
    text << "plugin '" << at->plugin->id << "' (" << at->file.c_str() << "), ";
    model = found;
    break;
  }
  if (model == nullptr) return;
  const char* name = call.instance != nullptr ? call.instance : model->id;
  text << "model '" << name << "'";
  if (call.instance != nullptr) text << " (" << model->id << ")";
  text << ", ";
}

bool are_consecutive(const suture_batch& batch) {
  for (std::uint32_t i = 1; i < batch.valid; ++i)
    if (batch.cell_ids[i] != batch.cell_ids[0] + i) return false;
  return true;
}

void describe_cells(const PluginCall& call, Text& text) {
  constexpr const char* one[] = {"vertex", "edge", "face", "element"};
  constexpr const char* many[] = {"vertices", "edges", "faces", "elements"};
  const suture_batch& batch = *call.batch;
  if (batch.valid == 0 || batch.valid > SUTURE_LANES || batch.cell_ids == nullptr) return;
  const std::uint32_t dimension = call.functor != nullptr ? call.functor->dimension % 4 : 3;
  text << " of " << (batch.valid == 1 ? one : many)[dimension] << " " << batch.cell_ids[0];
  if (batch.valid > 2 && are_consecutive(batch)) {
    text << " to " << batch.cell_ids[batch.valid - 1];
    return;
  }
  for (std::uint32_t i = 1; i < batch.valid; ++i) text << ", " << batch.cell_ids[i];
}

std::string name_of_type() {
  const std::type_info* type = abi::__cxa_current_exception_type();
  if (type == nullptr) return "unknown type";
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> name(
      abi::__cxa_demangle(type->name(), nullptr, nullptr, &status), std::free);
  return std::string("type ") + (status == 0 ? name.get() : type->name());
}

/// Warnings about calls; never destroyed, as plugins may be called until the program ends.
struct CallWarnings {
  std::mutex mutex;
  std::set<std::string> issued;
  std::vector<std::string> pending;
  std::atomic<bool> any = false;
};
CallWarnings& call_warnings() {
  static auto& warnings = *new CallWarnings;
  return warnings;
}

}  // namespace

void restore_modes(const PluginCall& call, const FloatModes& before) {
  const std::string what = FloatModes::now().difference(before);
  before.restore();
  PluginCall function = call;
  function.batch = nullptr;  // one warning, whatever the cells
  const std::string text =
      describe(function) + ": the plugin left " + what +
      " changed; it was restored, but what this function computed with it may differ in the last "
      "digits; restore it before the function returns (fegetenv, fesetenv), and link plugins "
      "without -ffast-math";
  CallWarnings& warnings = call_warnings();
  const std::lock_guard lock(warnings.mutex);
  if (!warnings.issued.insert(text).second) return;
  warnings.pending.push_back(text);
  warnings.any = true;
}

void deliver_plugin_warnings(Diagnostics& diagnostics) {
  CallWarnings& warnings = call_warnings();
  if (!warnings.any.load(std::memory_order_relaxed)) return;
  std::vector<std::string> pending;
  {
    const std::lock_guard lock(warnings.mutex);
    pending.swap(warnings.pending);
    warnings.any = false;
  }
  for (std::string& text : pending) diagnostics.warn(std::move(text));
}

void register_plugin(const suture_plugin& plugin, const std::filesystem::path& file) {
  const Loaded* first = all_loaded.load();
  for (const Loaded* at = first; at != nullptr; at = at->next)
    if (at->plugin == &plugin) return;
  all_loaded = new Loaded{&plugin, file.string(), first};  // NOLINT: as long as the program
}

std::size_t describe(const PluginCall& call, char* out, std::size_t size) {
  Text text(out, size);
  describe_plugin(call, text);
  if (call.functor != nullptr) text << "functor '" << call.functor->name << "', ";
  if (call.attribute != nullptr) text << "attribute '" << call.attribute->name << "', ";
  text << call.function;
  if (call.batch != nullptr) describe_cells(call, text);
  return text.size();
}

std::string describe(const PluginCall& call) {
  char text[2048];
  return {text, describe(call, text, sizeof text)};
}

std::string text_of(const suture_error& error) {
  const char* end = std::find(error.text, error.text + sizeof error.text, '\0');
  return end == error.text ? "failed without a message" : std::string(error.text, end);
}

std::string text_of_exception() {
  const std::string type = name_of_type();
  try {
    throw;
  } catch (const std::exception& error) {
    return "an exception of " + type + " (" + error.what() + ")";
  } catch (...) {
    return "an exception of " + type;
  }
}

std::string text_of_fault(const PluginCall& call) {
  try {
    throw;
  } catch (const PluginError& error) {  // of a check of the host
    return error.what();
  } catch (...) {
    return describe(call) + ": the plugin threw " + text_of_exception() + "; " + exception_cure;
  }
}

bool is_fault(suture_status status) {
  return status != SUTURE_OK && status != SUTURE_RETRY && status != SUTURE_STOP;
}

std::string text_of_fault(const PluginCall& call, suture_status status, const suture_error& error) {
  if (status == SUTURE_FAULT) return describe(call) + ": " + text_of(error);
  return describe(call) + ": the plugin returned the status " + std::to_string(status) +
         "; expected SUTURE_OK (0), SUTURE_RETRY (1), SUTURE_STOP (-1) or SUTURE_FAULT (-2)";
}

void raise_exception_of(const PluginCall& call) { throw PluginError(text_of_fault(call)); }

void raise_fault(const PluginCall& call, suture_status status, const suture_error& error) {
  throw PluginError(text_of_fault(call, status, error));
}

}  // namespace suture
