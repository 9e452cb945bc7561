// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one file that knows MPI.
#include <mpi.h>

#include <chrono>
#include <numeric>
#include <thread>

#include "kernel/processes/communicator.hpp"

namespace suture {
namespace {

class MpiCommunicator final : public Communicator {
 public:
  MpiCommunicator() {
    int given = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &given);
    MPI_Comm_dup(MPI_COMM_WORLD, &ends_);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    offsets_.resize(static_cast<std::size_t>(size_));
  }
  ~MpiCommunicator() override { MPI_Finalize(); }

  unsigned rank() const override { return static_cast<unsigned>(rank_); }
  unsigned size() const override { return static_cast<unsigned>(size_); }

  void gather(std::span<const double> mine, std::span<const int> counts, double* all) override {
    find_offsets(counts);
    MPI_Request request;
    MPI_Iallgatherv(mine.data(), static_cast<int>(mine.size()), MPI_DOUBLE, all, counts.data(),
                    offsets_.data(), MPI_DOUBLE, MPI_COMM_WORLD, &request);
    wait(request);
  }

  void complete(double* all, std::span<const int> counts) override {
    find_offsets(counts);
    MPI_Request request;
    MPI_Iallgatherv(MPI_IN_PLACE, 0, MPI_DOUBLE, all, counts.data(), offsets_.data(), MPI_DOUBLE,
                    MPI_COMM_WORLD, &request);
    wait(request);
  }

  std::vector<std::string> gather(const std::string& mine) override {
    const int length = static_cast<int>(mine.size());
    std::vector<int> lengths(offsets_.size());
    MPI_Allgather(&length, 1, MPI_INT, lengths.data(), 1, MPI_INT, MPI_COMM_WORLD);
    find_offsets(lengths);
    std::string all(std::reduce(lengths.begin(), lengths.end(), std::size_t{0}), ' ');
    MPI_Allgatherv(mine.data(), length, MPI_CHAR, all.data(), lengths.data(), offsets_.data(),
                   MPI_CHAR, MPI_COMM_WORLD);
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < lengths.size(); ++i)
      texts.push_back(
          all.substr(static_cast<std::size_t>(offsets_[i]), static_cast<std::size_t>(lengths[i])));
    return texts;
  }

  int largest(int mine) override {
    int result = 0;
    MPI_Request request;
    MPI_Iallreduce(&mine, &result, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD, &request);
    wait(request);
    return result;
  }

  void meet_error() override {
    if (error_ == MPI_REQUEST_NULL) MPI_Ibarrier(ends_, &error_);
  }

  bool all_meet_error() override {
    const std::chrono::seconds time(error_ == MPI_REQUEST_NULL ? 5 : 60);
    meet_error();
    const auto last = std::chrono::steady_clock::now() + time;
    int done = 0;
    while (MPI_Test(&error_, &done, MPI_STATUS_IGNORE), done == 0) {
      if (std::chrono::steady_clock::now() > last) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }

  void abort(int code) override {
    MPI_Abort(MPI_COMM_WORLD, code);
    std::abort();
  }

 private:
  /// Spins while the others are about to arrive. Then it leaves the core to them: a process that
  /// waits in MPI would keep it to the end of its time slice.
  static void wait(MPI_Request& request) {
    constexpr int spins = 1000;
    int done = 0;
    for (int i = 0; MPI_Test(&request, &done, MPI_STATUS_IGNORE), done == 0; ++i)
      if (i > spins) std::this_thread::sleep_for(std::chrono::microseconds(20));
  }
  void find_offsets(std::span<const int> counts) {
    std::exclusive_scan(counts.begin(), counts.end(), offsets_.begin(), 0);
  }

  MPI_Comm ends_ = MPI_COMM_NULL;  ///< for errors, while others may wait in another call
  MPI_Request error_ = MPI_REQUEST_NULL;
  int rank_ = 0, size_ = 1;
  std::vector<int> offsets_;
};

}  // namespace
}  // namespace suture

extern "C" __attribute__((visibility("default"))) suture::Communicator*
suture_processes_module_1() {
  return new suture::MpiCommunicator;
}
