// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/ledger.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "kernel/forces/contact_law.hpp"

namespace suture {

double EnergyBalance::work(std::string_view term) const {
  for (const Work& work : works)
    if (work.term == term) return work.value;
  return 0;
}

void EnergyBalance::state(Archive& archive) {
  archive("kinetic", kinetic);
  archive("elastic", elastic);
  archive("prescribed", prescribed);
  archive("models", models);
  archive("events", events);
  archive("dissipated", dissipated);
  archive("balance", balance);
  archive("recoverable", recoverable);
  archive("exchanged", exchanged);
}

void Ledger::book(double time) {
  for_each_with<WorkTerm>(body_.terms(), [&](WorkTerm& term) { term.book(time); });
}

bool Ledger::needs_work() const {
  const ForceLoop& models = body_.models();
  return models.dissipates() || !models.has(ForceLoop::Part::with_energy);
}

/// Work of prescribed motion in the half step that is not complete.
double Ledger::driven_until(const Now& now) const {
  return sums_.noted_driven() + body_.constraints().work_until_now(body_.attributes(),
                                                                   body_.acceleration(now.time),
                                                                   now.half_step);
}

EnergyBalance Ledger::balance(const Now& now) {
  const ForceLoop& models = body_.models();
  book(now.time);
  EnergyBalance b;
  b.kinetic = now.kinetic;
  b.elastic = body_.energy(now.time);
  const double driven = body_.constraints().driven_kinetic(body_.attributes());
  if (!account_.has_start) {
    account_.has_start = true;
    account_.start = b.kinetic + b.elastic;
    account_.start_elastic = b.elastic;
    account_.start_driven = driven;
  }
  const double stored = b.elastic - account_.start_elastic - account_.events_elastic;
  for (const auto& term : body_.loads()) {
    const auto* of_term = dynamic_cast<const WorkTerm*>(term.get());
    b.works.push_back({term->name(), of_term ? of_term->work() : 0});
  }
  b.prescribed = sums_.driven_work() + driven_until(now) + account_.pending_driven + driven -
                 account_.start_driven;
  b.events = account_.events;
  b.dissipated = sums_.damped();
  double internal = sums_.work() + now.work + account_.pending_work;
  double balance = b.kinetic + b.elastic - account_.start;
  double largest = std::max(sums_.largest_kinetic(), b.kinetic + std::abs(stored));
  const ContactLaw* contact = body_.contact();
  if (contact && contact->is_term()) b.works.push_back({"friction", contact->friction_work()});
  for (const EnergyBalance::Work& work : b.works) internal -= work.value;
  if (contact && !contact->is_term()) {  // impulses are not in the sums of forces
    b.works.push_back({"contact", contact->work() + now.contact + account_.pending_contact});
    b.works.push_back({"friction", contact->friction_work()});
    if (const auto cutting = contact->cutting_work()) b.works.push_back({"cutting", *cutting});
  }
  for (const EnergyBalance::Work& work : b.works) {
    balance -= work.value;
    largest = std::max(largest, std::abs(work.value));
  }
  b.models = models.has(ForceLoop::Part::with_energy) ? models.work() : internal + stored;
  if (models.dissipates()) b.dissipated -= internal - b.models + stored;
  b.balance = balance - b.prescribed - b.models - b.events + b.dissipated;
  b.recoverable = now.leapfrog_part - account_.leapfrog_start;
  b.exchanged = std::max({account_.exchanged, largest, std::abs(b.prescribed)});
  return b;
}

void Ledger::before_jump(const Now& now) {
  book(now.time);
  jump_.leapfrog_start = now.leapfrog_part;
  jump_.start_elastic = body_.energy(now.time);
  jump_.start = now.kinetic + jump_.start_elastic;
  jump_.start_driven = body_.constraints().driven_kinetic(body_.attributes());
  jump_.pending_driven = driven_until(now);
  jump_.pending_work = now.work;
  jump_.pending_contact = now.contact;
}

void Ledger::after_jump(const Now& now) {
  const double elastic = body_.energy(now.time);
  account_.events += now.kinetic + elastic - jump_.start;
  account_.events_elastic += elastic - jump_.start_elastic;
  account_.start_driven +=
      body_.constraints().driven_kinetic(body_.attributes()) - jump_.start_driven;
  account_.leapfrog_start += now.leapfrog_part - jump_.leapfrog_start;
  account_.pending_driven += jump_.pending_driven - driven_until(now);
  account_.pending_work += jump_.pending_work - now.work;
  account_.pending_contact += jump_.pending_contact - now.contact;
  book(now.time);
}

void Ledger::book_jump(const Part& before, const Part& after) {
  const double elastic = after.elastic - before.elastic;
  account_.events += after.kinetic - before.kinetic + elastic;
  account_.events_elastic += elastic;
  account_.leapfrog_start += after.leapfrog_part - before.leapfrog_part;
  account_.pending_work += before.work - after.work;
}

void Ledger::state(Archive& archive) {
  archive("has start", account_.has_start);
  archive("start", account_.start);
  archive("start elastic", account_.start_elastic);
  archive("start driven", account_.start_driven);
  archive("events", account_.events);
  archive("events elastic", account_.events_elastic);
  archive("owed driven", account_.pending_driven);
  archive("owed work", account_.pending_work);
  archive("owed contact", account_.pending_contact);
  archive("exchanged", account_.exchanged);
  archive("leapfrog start", account_.leapfrog_start);
}

}  // namespace suture
