// SPDX-License-Identifier: GPL-3.0-or-later
//
// A plugin that makes the mistakes of plugin authors, one at a time: those of its functions by
// the parameter "how", those of its tables and of its loading by the environment variable
// SUTURE_TEST_MISTAKE. Written on the C tables, as the C++ layer prevents most of them.
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string_view>
#include <thread>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "suture/model.hpp"

SUTURE_NOTE("mistakes", "mistakes")

namespace {

constexpr std::uint32_t lanes = SUTURE_LANES;
constexpr const char* ways[] = {"nothing",
                                "prepare-throws",
                                "prepare-crashes",
                                "prepare-writes-behind",
                                "prepare-writes-far",
                                "prepare-rounds",
                                "prepare-status",
                                "prepare-fault",
                                "enabled-throws",
                                "contribution-throws",
                                "contribution-crashes",
                                "contribution-writes-far",
                                "contribution-nan",
                                "contribution-negative",
                                "contribution-status",
                                "contribution-fault",
                                "extension-throws",
                                "inspect-crashes",
                                "inspect-status",
                                "inspect-fault",
                                "force-throws",
                                "force-throws-int",
                                "force-throws-own",
                                "force-bad-alloc",
                                "force-noexcept",
                                "force-exits",
                                "force-quick-exits",
                                "force-ends-process",
                                "force-ends-process-elsewhere",
                                "force-becomes-another",
                                "force-starts-another",
                                "force-rounds",
                                "force-flushes",
                                "force-traps",
                                "force-sleeps",
                                "force-locks-twice",
                                "later-sleeps",
                                "later-exits-silently",
                                "force-loops-unsignalled",
                                "force-aborts",
                                "force-crashes",
                                "force-overflows",
                                "force-divides",
                                "force-loops",
                                "force-says-and-loops",
                                "force-nan",
                                "force-unset",
                                "force-adds",
                                "force-mixes-lanes",
                                "force-writes-before",
                                "force-writes-behind",
                                "force-writes-far-before",
                                "force-writes-far",
                                "force-reads-far",
                                "force-protects",
                                "force-writes-input",
                                "force-status",
                                "force-fault",
                                "force-text",
                                "energy-throws",
                                "energy-nan",
                                "energy-status",
                                "energy-fault",
                                "bounds-throws",
                                "bounds-nan"};

bool is(const suture_context* context, std::string_view how) {
  return ways[static_cast<std::size_t>(context->parameters[0])] == how;
}

volatile int zero = 0;
int* volatile nowhere = nullptr;
struct OwnType {};

/// Ends or replaces the process, or stops this thread for ever.
void leave(std::string_view how) {
  if (how == "ends-process") _exit(0);
  if (how == "ends-process-elsewhere") std::thread([] { _exit(0); }).join();
  if (how == "becomes-another") execl("/bin/true", "true", static_cast<char*>(nullptr));
  if (how == "starts-another" && std::system("true") != 0) std::abort();  // no mistake
  if (how == "sleeps")
    while (true) pause();
  static std::mutex lock;
  if (how == "locks-twice") lock.lock(), lock.lock();
  if (how != "loops-unsignalled") return;
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, nullptr);
  while (true) zero = 0;
}

/// Leaves the floating-point modes changed.
void change_modes(std::string_view how) {
  if (how == "rounds") std::fesetround(FE_UPWARD);
#if defined(__x86_64__)
  if (how == "flushes") _mm_setcsr(_mm_getcsr() | 0x8040);
#endif
  if (how == "traps") feenableexcept(FE_DIVBYZERO);
}

int overflow(volatile const char* outer) {
  volatile char here[4096] = {};
  if (outer[0] != 0) return 0;  // never
  return overflow(here) + here[1];
}
[[gnu::noinline]] void throw_error() { throw std::runtime_error("the law has lost its way"); }
void throw_from_noexcept() noexcept { throw_error(); }

bool mistake_is(std::string_view name) {
  const char* mistake = std::getenv("SUTURE_TEST_MISTAKE");
  return mistake != nullptr && mistake == name;
}

/// What ends a call in another way than by returning.
void fail(const suture_context* context, std::string_view function) {
  const auto fails = [&](const char* way) {
    return is(context, std::string(function) + "-" + way);
  };
  if (fails("throws")) throw_error();
  if (fails("throws-int")) throw 42;
  if (fails("throws-own")) throw OwnType();
  if (fails("bad-alloc")) throw std::bad_alloc();
  if (fails("noexcept")) throw_from_noexcept();
  if (fails("exits")) std::exit(0);
  if (fails("quick-exits")) std::quick_exit(0);
  if (fails("aborts")) std::abort();
  if (fails("crashes")) *nowhere = 1;
  if (fails("overflows")) zero = overflow("");
  if (fails("divides")) zero = 100 / zero;
  while (fails("loops")) zero = 0;
  const std::string_view how = ways[static_cast<std::size_t>(context->parameters[0])];
  if (!how.starts_with(function) || how.size() <= function.size()) return;
  leave(how.substr(function.size() + 1));
  change_modes(how.substr(function.size() + 1));
}

/// What a call returns that does not end in another way.
suture_status status(const suture_context* context, std::string_view function) {
  fail(context, function);
  if (is(context, std::string(function) + "-status")) return 77;
  if (!is(context, std::string(function) + "-fault")) return SUTURE_OK;
  std::strcpy(context->error->text, "the tables of the law are not loaded; call load() first");
  return SUTURE_FAULT;
}

/// Mistakes in writing the forces, all of which are zero else.
void write_forces(const suture_context* context, const suture_batch* batch) {
  const std::uint32_t size = batch->nodes * 3 * lanes;
  double* force = batch->force;
  if (is(context, "force-adds")) {
    for (std::uint32_t i = 0; i < size; ++i) force[i] += 0;
    return;
  }
  for (std::uint32_t i = 0; i < size; ++i)
    if (!is(context, "force-unset") || i / (3 * lanes) != 5) force[i] = 0;
  if (is(context, "force-nan")) force[2 * 3 * lanes + 1] = std::numeric_limits<double>::quiet_NaN();
  if (is(context, "force-mixes-lanes")) force[0] = batch->position[1] - batch->position[0];
  if (is(context, "force-writes-before")) force[-1] = 0;
  if (is(context, "force-writes-behind")) force[size] = 0;
  if (is(context, "force-writes-far-before"))
    for (std::uint32_t i = 1; i < 4000; ++i) force[-static_cast<std::ptrdiff_t>(i)] = 1e9;
  if (is(context, "force-writes-far"))
    for (std::uint32_t i = 4096; i < 400000; ++i) force[i] = 1e9;
  if (is(context, "force-reads-far")) force[0] = 0 * batch->position[4096];
  if (is(context, "force-protects"))
    mprotect(reinterpret_cast<void*>(reinterpret_cast<std::uintptr_t>(force) & ~0xfffUL), 4096,
             PROT_READ);
  if (is(context, "force-protects")) force[0] = 0;
  if (is(context, "force-writes-input")) const_cast<double*>(batch->position)[3] += 1e-9;
}

/// In the middle of a run.
void fail_later(const suture_context* context) {
  if (is(context, "later-sleeps")) std::fclose(std::fopen("sleeping", "w"));
  if (is(context, "later-sleeps")) leave("sleeps");
  if (is(context, "later-exits-silently")) syscall(SYS_exit_group, 0);  // found by nobody
}

suture_status force(const suture_context* context, const suture_batch* batch) {
  const suture_status result = status(context, "force");
  if (is(context, "force-says-and-loops")) std::fclose(std::fopen("looping", "w"));
  while (is(context, "force-says-and-loops")) zero = 0;
  if (batch->time > 0.005) fail_later(context);
  write_forces(context, batch);
  if (is(context, "force-text"))
    std::memset(context->error->text, 'x', sizeof context->error->text);
  if (is(context, "force-text")) return SUTURE_STOP;
  return result;
}

suture_status energy(const suture_context* context, const suture_batch*, double* out) {
  const suture_status result = status(context, "energy");
  for (std::uint32_t l = 0; l < lanes; ++l)
    out[l] = is(context, "energy-nan") ? std::numeric_limits<double>::quiet_NaN() : 0;
  return result;
}

suture_status bounds(const suture_context* context, const suture_batch*, double* stiffness,
                     double*) {
  const suture_status result = status(context, "bounds");
  if (is(context, "bounds-nan"))
    stiffness[2 * 6 * lanes + 3] = std::numeric_limits<double>::quiet_NaN();
  return result;
}

suture_status inspect(const suture_context* context, const suture_batch*) {
  return status(context, "inspect");
}

/// Extensions get no context: the parameters of the last instance serve.
const double* parameters_of_last = nullptr;

const void* extension(const char* id) {
  static suture_energy_1 energies{sizeof(suture_energy_1), 0, energy};
  constexpr static suture_inspect_1 inspection{sizeof(suture_inspect_1), 0, inspect};
  constexpr static suture_stable_dt_1 stable_dt{sizeof(suture_stable_dt_1), 0, bounds};
  if (mistake_is("no-energy")) energies.energy = nullptr;
  suture_context context{};
  context.parameters = parameters_of_last;
  if (parameters_of_last != nullptr) fail(&context, "extension");
  if (id == std::string_view(SUTURE_ENERGY_1)) return &energies;
  if (id == std::string_view(SUTURE_INSPECT_1)) return &inspection;
  if (id == std::string_view(SUTURE_STABLE_DT_1)) return &stable_dt;
  return nullptr;
}

std::int32_t enabled(const suture_context* context, std::uint32_t*) {
  fail(context, "enabled");
  return 1;
}

suture_status prepare(const suture_context* context, void* instance) {
  parameters_of_last = context->parameters;
  static_cast<double*>(instance)[0] = 1;
  if (is(context, "prepare-writes-behind")) static_cast<double*>(instance)[1] = 1;
  if (is(context, "prepare-writes-far")) std::fill_n(static_cast<double*>(instance), 100000, 1.0);
  return status(context, "prepare");
}

/// 1 kg per element.
suture_status contribute(const suture_context* context, const suture_batch*, double* out) {
  const suture_status result = status(context, "contribution");
  double share = 0.125;
  if (is(context, "contribution-nan")) share = std::numeric_limits<double>::quiet_NaN();
  if (is(context, "contribution-negative")) share = -share;
  for (std::uint32_t i = 0; i < 8 * lanes; ++i) out[i] = share;
  if (is(context, "contribution-writes-far")) std::fill_n(out, 100000, share);
  return result;
}

suture_parameter parameters[] = {
    suture::choice("how", "which mistake", ways),
    suture::number("E", "Pa", "not used").or_else(1).at_least(0).at_most(2)};

suture_contribution contributions[] = {
    {.size = sizeof(suture_contribution), .cell_type = SUTURE_HEXAHEDRON, .function = contribute}};

suture_attribute attributes[] = {{.size = sizeof(suture_attribute),
                                  .dimension = 0,
                                  .components = 1,
                                  .policy = SUTURE_FROM_VOLUMES,
                                  .flags = SUTURE_SHARED_MASS,
                                  .contribution_count = 1,
                                  .name = "mass",
                                  .unit = "kg",
                                  .doc = "share of the mass",
                                  .initial = 0,
                                  .contributions = contributions,
                                  .minimum = 0,
                                  .maximum = 0}};

const std::uint32_t missing_column[] = {3};

suture_functor functors[] = {{.size = sizeof(suture_functor),
                              .dimension = 3,
                              .cell_type = SUTURE_HEXAHEDRON,
                              .shape = SUTURE_ANY_SHAPE,
                              .faces = SUTURE_ALL_FACES,
                              .lanes = lanes,
                              .scalar = 0,
                              .reads = SUTURE_READ_REST | SUTURE_READ_POSITION,
                              .cell_column_count = 0,
                              .vertex_column_count = 0,
                              .alternative = 0,
                              .reserved = 0,
                              .cell_columns = missing_column,
                              .vertex_columns = nullptr,
                              .name = "elements",
                              .doc = "Fails on demand.",
                              .force = force,
                              .extension = extension,
                              .enabled = enabled,
                              .field = 0,
                              .reserved_2 = 0}};

suture_model models[] = {{.size = sizeof(suture_model),
                          .flags = 0,
                          .id = "mistakes",
                          .doc = "Fails on demand",
                          .formula = "f = 0",
                          .citation = "none",
                          .parameter_count = 2,
                          .attribute_count = 1,
                          .functor_count = 1,
                          .reserved = 0,
                          .parameters = parameters,
                          .attributes = attributes,
                          .functors = functors,
                          .prepare = prepare,
                          .instance_bytes = sizeof(double),
                          .extension = nullptr}};

const suture_plugin plugin = {.size = sizeof(suture_plugin),
                              .magic = SUTURE_MAGIC,
                              .abi_major = SUTURE_ABI_MAJOR,
                              .abi_minor = SUTURE_ABI_MINOR,
                              .lanes = lanes,
                              .model_count = 1,
                              .id = "mistakes",
                              .version = "1.0",
                              .license = "GPL-3.0-or-later",
                              .description = "Mistakes of authors",
                              .models = models,
                              .required_extension_count = 0,
                              .reserved = 0,
                              .required_extensions = nullptr};

[[gnu::constructor]] void load() {
  if (mistake_is("loading-exits")) std::exit(0);
  if (mistake_is("loading-crashes")) *nowhere = 1;
}

}  // namespace

extern "C" [[gnu::visibility("default")]] const suture_plugin* suture_plugin_v1() {
  if (mistake_is("table-throws")) throw 42;
  if (mistake_is("table-crashes")) *nowhere = 1;
  if (mistake_is("dimension")) functors[0].dimension = 4;
  if (mistake_is("cell-type")) functors[0].cell_type = SUTURE_EDGE;
  if (mistake_is("column")) functors[0].cell_column_count = 1;
  if (mistake_is("same-parameter")) parameters[1].name = "how";
  if (mistake_is("default")) parameters[1].default_value = 3;
  if (mistake_is("formula")) models[0].formula = nullptr;
  if (mistake_is("no-force")) functors[0].force = nullptr;
  if (mistake_is("no-contribution")) contributions[0].function = nullptr;
  return &plugin;
}
