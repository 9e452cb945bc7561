// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/processes/communicator.hpp"

#include <cstdlib>
#include <string_view>

#include "kernel/base/error.hpp"
#include "kernel/base/module.hpp"

namespace suture {

bool is_one_of_several() {
  for (const char* size : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* value = std::getenv(size)) return value != std::string_view("1");
  return std::getenv("PMIX_RANK") != nullptr;
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
  return std::unique_ptr<Communicator>(reinterpret_cast<Factory>(symbol)());
}

}  // namespace suture
