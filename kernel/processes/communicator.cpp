// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/processes/communicator.hpp"

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>

#include "kernel/base/error.hpp"
#include "kernel/base/module.hpp"

namespace suture {

namespace {

/// The number of processes that the launcher has started; "": it does not say.
std::string number_started() {
  for (const char* size : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* value = std::getenv(size)) return value;
  return "";
}

}  // namespace

std::string name_of_machine() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

bool is_one_of_several() {
  const std::string started = number_started();
  return started.empty() ? std::getenv("PMIX_RANK") != nullptr : started != "1";
}

std::unique_ptr<Communicator> join_processes() {
  using Factory = Communicator* (*)();
  void* symbol = nullptr;
  try {
    symbol = module_symbol("libsuture-processes.so", "suture_processes_module_1");
  } catch (const IoError& error) {
    throw InputError(std::string("several processes cannot make one run here: ") + error.what() +
                     "; this part is built where MPI is found (Debian: libopenmpi-dev)");
  }
  std::unique_ptr<Communicator> joined(reinterpret_cast<Factory>(symbol)());
  const std::string started = number_started(), found = std::to_string(joined->size());
  if (!started.empty() && started != found)
    throw InputError("the launcher has started " + started + " processes, but MPI finds " + found +
                     ": they belong to different MPI libraries; start the run with the launcher "
                     "of the MPI that libsuture-processes.so was built with");
  return joined;
}

}  // namespace suture
