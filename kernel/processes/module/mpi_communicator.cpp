// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one file that knows MPI.
#include <mpi.h>
#include <sys/prctl.h>

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
    prctl(PR_SET_TIMERSLACK, 1000UL);  // ns: by default, the naps of wait() last 50 us longer
  }
  ~MpiCommunicator() override { MPI_Finalize(); }

  unsigned rank() const override { return static_cast<unsigned>(rank_); }
  unsigned size() const override { return static_cast<unsigned>(size_); }

  void gather(std::span<const double> mine, std::span<const int> counts, double* all) override {
    find_offsets(counts);
    note_exchange(mine.size() * sizeof(double));
    MPI_Request request;
    MPI_Iallgatherv(mine.data(), static_cast<int>(mine.size()), MPI_DOUBLE, all, counts.data(),
                    offsets_.data(), MPI_DOUBLE, MPI_COMM_WORLD, &request);
    wait(request);
  }

  void complete(double* all, std::span<const int> counts) override {
    find_offsets(counts);
    note_exchange(static_cast<std::size_t>(counts[static_cast<std::size_t>(rank_)]) *
                  sizeof(double));
    MPI_Request request;
    MPI_Iallgatherv(MPI_IN_PLACE, 0, MPI_DOUBLE, all, counts.data(), offsets_.data(), MPI_DOUBLE,
                    MPI_COMM_WORLD, &request);
    wait(request);
  }

  void collect(std::span<const double> mine, std::span<const int> counts, double* all) override {
    find_offsets(counts);
    note_exchange(rank_ == 0 ? 0 : mine.size() * sizeof(double));
    const bool is_in_place = rank_ == 0 && mine.data() == all;
    MPI_Request request;
    MPI_Igatherv(is_in_place ? MPI_IN_PLACE : mine.data(), static_cast<int>(mine.size()),
                 MPI_DOUBLE, all, counts.data(), offsets_.data(), MPI_DOUBLE, 0, MPI_COMM_WORLD,
                 &request);
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

  std::vector<std::vector<std::uint32_t>> swap(
      const std::vector<std::vector<std::uint32_t>>& lists) override {
    std::vector<int> counts, starts(lists.size());
    std::vector<std::uint32_t> mine;
    for (const auto& list : lists) {
      counts.push_back(static_cast<int>(list.size()));
      mine.insert(mine.end(), list.begin(), list.end());
    }
    std::exclusive_scan(counts.begin(), counts.end(), starts.begin(), 0);
    std::vector<int> lengths(lists.size());
    MPI_Alltoall(counts.data(), 1, MPI_INT, lengths.data(), 1, MPI_INT, MPI_COMM_WORLD);
    find_offsets(lengths);
    std::vector<std::uint32_t> all(std::reduce(lengths.begin(), lengths.end(), std::size_t{0}));
    MPI_Alltoallv(mine.data(), counts.data(), starts.data(), MPI_UINT32_T, all.data(),
                  lengths.data(), offsets_.data(), MPI_UINT32_T, MPI_COMM_WORLD);
    std::vector<std::vector<std::uint32_t>> result;
    for (std::size_t i = 0; i < lists.size(); ++i)
      result.emplace_back(all.begin() + offsets_[i], all.begin() + offsets_[i] + lengths[i]);
    return result;
  }

  void swap(std::span<const Parcel> out, std::span<Parcel> in) override {
    requests_.clear();
    for (Parcel& parcel : in)
      MPI_Irecv(parcel.numbers.data(), static_cast<int>(parcel.numbers.size()), MPI_DOUBLE,
                static_cast<int>(parcel.process), 0, MPI_COMM_WORLD, &requests_.emplace_back());
    for (const Parcel& parcel : out) {
      ++traffic_.messages;
      traffic_.bytes += parcel.numbers.size() * sizeof(double);
      MPI_Isend(parcel.numbers.data(), static_cast<int>(parcel.numbers.size()), MPI_DOUBLE,
                static_cast<int>(parcel.process), 0, MPI_COMM_WORLD, &requests_.emplace_back());
    }
    for (MPI_Request& request : requests_) wait(request);
  }

  const Traffic& traffic() const override { return traffic_; }

  int largest(int mine) override {
    note_exchange(sizeof mine);
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
    if (is_alone_) return false;
    const std::chrono::seconds time(error_ == MPI_REQUEST_NULL && !has_met_ ? 5 : 60);
    meet_error();
    const auto last = std::chrono::steady_clock::now() + time;
    int done = 0;
    while (MPI_Test(&error_, &done, MPI_STATUS_IGNORE), done == 0) {
      is_alone_ = std::chrono::steady_clock::now() > last;
      if (is_alone_) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return has_met_ = true;
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
  void note_exchange(std::size_t bytes) {
    ++traffic_.exchanges;
    traffic_.exchanged_bytes += bytes;
  }
  void find_offsets(std::span<const int> counts) {
    std::exclusive_scan(counts.begin(), counts.end(), offsets_.begin(), 0);
  }

  MPI_Comm ends_ = MPI_COMM_NULL;  ///< for errors, while others may wait in another call
  MPI_Request error_ = MPI_REQUEST_NULL;
  bool has_met_ = false, is_alone_ = false;  ///< others have, or have not met an error
  int rank_ = 0, size_ = 1;
  std::vector<int> offsets_;
  std::vector<MPI_Request> requests_;
  Traffic traffic_;
};

}  // namespace
}  // namespace suture

extern "C" __attribute__((visibility("default"))) suture::Communicator*
suture_processes_module_1() {
  return new suture::MpiCommunicator;
}
