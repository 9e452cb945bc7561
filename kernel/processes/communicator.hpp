// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace suture {

/// The processes that make one run together, and what they tell each other. Every function but the
/// first two and traffic() waits until all of them have called it.
class Communicator {
 public:
  virtual ~Communicator() = default;

  virtual unsigned rank() const = 0;  ///< 0 .. size() - 1; process 0 writes the results
  virtual unsigned size() const = 0;

  /// Writes the numbers of all processes to `all`, one after the other; process i gives counts[i].
  virtual void gather(std::span<const double> mine, std::span<const int> counts, double* all) = 0;
  /// The same where all[...] already has the numbers of this process in their place.
  virtual void complete(double* all, std::span<const int> counts) = 0;
  /// Process 0 alone gets the numbers of all; `mine` may stand in their place.
  virtual void collect(std::span<const double> mine, std::span<const int> counts, double* all) = 0;
  /// The texts of all processes.
  virtual std::vector<std::string> gather(const std::string& mine) = 0;
  /// The lists that all processes have for this one, from lists[i] for process i.
  virtual std::vector<std::vector<std::uint32_t>> swap(
      const std::vector<std::vector<std::uint32_t>>& lists) = 0;
  /// Numbers for a process, or from it.
  struct Parcel {
    unsigned process;
    std::vector<double> numbers;
  };
  /// Sends each of `out` and fills each of `in`. Waits for these processes only.
  virtual void swap(std::span<const Parcel> out, std::span<Parcel> in) = 0;
  /// What this process has sent to single processes, and to all in exchanges that all make.
  struct Traffic {
    std::uint64_t messages = 0, bytes = 0, exchanges = 0, exchanged_bytes = 0;
  };
  virtual const Traffic& traffic() const = 0;
  /// The largest number of all processes.
  virtual int largest(int mine) = 0;

  /// This process has met an error that the others should meet, too. Does not wait; call it before
  /// what takes time, such as writing.
  virtual void meet_error() = 0;
  /// False if others do not meet it in time: 5 s, or a minute if meet_error() was called before, as
  /// process 0 may still be writing what stands before the error. May be called again: then they
  /// have to come here again.
  virtual bool all_meet_error() = 0;

  /// Ends all processes at once.
  [[noreturn]] virtual void abort(int code) = 0;
};

/// True if a launcher of MPI has started this process as one of several.
bool is_one_of_several();
/// That of this process.
std::string name_of_machine();
/// Joins the processes that were started together, once per process. Loads libsuture-processes.so,
/// and with it MPI. Throws InputError if this program was built without it,
/// or if MPI finds another number of processes than the launcher has started.
std::unique_ptr<Communicator> join_processes();

}  // namespace suture
