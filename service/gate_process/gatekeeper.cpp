// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/gatekeeper.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "surefoot/gate/goal.hpp"
#include "surefoot/gate/verdict_text.hpp"

namespace surefoot::gate_process {
namespace {

constexpr std::int64_t kOpenEvery_ns = 100'000'000;
constexpr std::int64_t kCanaryEvery_ns = 250'000'000;

/// The map before the first snapshot: one unknown cell from a camera without images. It is sealed,
/// so that the gate reports missing input instead of damage.
std::unique_ptr<grid::MapSnapshot> nothing_seen() {
    auto map = std::make_unique<grid::MapSnapshot>();
    map->resolution_tenth_mm = 250;
    map->nx = map->ny = 1;
    map->height_tenth_mm.fill(grid::MapSnapshot::kUnknownHeight);
    grid::seal(*map);
    return map;
}

std::int64_t tenth_mm(double length_m) {
    // in range: check_radius() accepts only numbers up to the limit of the machine file
    return std::llround(length_m * 1e4);
}

Status refuse_attestation(const std::string& why) {
    return Error{ErrorCode::usage, "the ground cannot be attested: " + why};
}

}  // namespace

Gatekeeper::Gatekeeper(const Machine& machine,
                       const gate::ReadinessLimits& limits,
                       ChannelAddress channel,
                       Audit audit,
                       AuditAct audit_act)
    : machine_(machine),
      channel_(std::move(channel)),
      audit_(std::move(audit)),
      audit_act_(std::move(audit_act)),
      readiness_(machine, limits),
      canaries_(std::make_unique<gate::Canaries>(machine)),
      map_(nothing_seen()),
      incoming_(nothing_seen()) {
    for (std::size_t code = 0; code < machine_.movements.size(); ++code) {
        if (machine_.movements[code].configured)
            movements_[movement_count_++] = static_cast<std::uint8_t>(code);
    }
}

void Gatekeeper::poll(std::int64_t now_ns, std::int64_t boottime_ns) {
    if (readiness_.state() == gate::GateState::init)
        readiness_.self_tested(canaries_->judge_all().passed, now_ns);
    fetch(now_ns);
    readiness_.clocks(now_ns, boottime_ns);
    ask_canary(now_ns);
    give_starters_word(now_ns);
}

void Gatekeeper::open_channel(std::int64_t now_ns) {
    const bool wanted =
        channel_state_ == ChannelState::absent || channel_state_ == ChannelState::lost;
    if (!wanted || now_ns < next_open_ns_) return;
    next_open_ns_ = now_ns + kOpenEvery_ns;
    if (reader_) {
        if (reader_->reopen()) channel_state_ = ChannelState::open;
        return;
    }
    auto reader = SnapshotReader::open(channel_);
    if (!reader) return;
    reader_.emplace(std::move(*reader));
    channel_state_ = ChannelState::open;
    readiness_.resume_fault(reader_->kept_faults());
}

SnapshotReader::Read Gatekeeper::read_channel(std::int64_t now_ns) {
    open_channel(now_ns);
    const auto read = reader_ ? reader_->read(*incoming_) : SnapshotReader::Read::nothing;
    if (read == SnapshotReader::Read::lost) channel_state_ = ChannelState::lost;
    if (read == SnapshotReader::Read::forged) {
        channel_state_ = ChannelState::forged;
        readiness_.snapshot_forged(now_ns);
    }
    return read;
}

/// True if `incoming_` may be used now. The process can pause between reading the clock and reading
/// the channel. A frame from this pause is not from the future, so it waits for the next call. It
/// waits only once, because a wrong stamp stays ahead of the clock.
bool Gatekeeper::has_arrived(SnapshotReader::Read read, std::int64_t now_ns) noexcept {
    using Read = SnapshotReader::Read;
    if (read != Read::fresh && !(read == Read::same && waits_)) {
        if (read != Read::same) waits_ = false;  // the waiting snapshot may have been overwritten
        return false;
    }
    const bool is_ahead = incoming_->frame_time_ns > now_ns || incoming_->pose_time_ns > now_ns;
    waits_ = is_ahead && !waits_;
    return !waits_;
}

void Gatekeeper::fetch(std::int64_t now_ns) {
    const auto read = read_channel(now_ns);
    if (reader_ && reader_->writer() != writer_) {
        writer_ = reader_->writer();
        has_map_ = waits_ = false;
        map_ = nothing_seen();
        attestation_.revoke();
        readiness_.perception_restarted(now_ns);
    }
    if (has_arrived(read, now_ns) && writer_ != given_up_) {
        std::swap(map_, incoming_);
        has_map_ = true;
        readiness_.observe(*map_, now_ns);
        attestation_.observe(*map_, now_ns);
    }
    readiness_.tick(now_ns);
    if (readiness_.state() != gate::GateState::fault) return;
    attestation_.revoke();
    if (reader_) reader_->keep_faults(readiness_.latched().bits());
}

void Gatekeeper::ask_canary(std::int64_t now_ns) {
    if (now_ns < next_canary_ns_) return;
    next_canary_ns_ = now_ns + kCanaryEvery_ns;
    readiness_.self_tested(canaries_->judge(canary_).passed, now_ns);
    canary_ = (canary_ + 1) % canaries_->count();
}

gate::GateHealth Gatekeeper::health() const noexcept {
    gate::GateHealth health = readiness_.health();
    if (log_failing_) health.faults.add(gate::Reason::audit);
    return health;
}

bool Gatekeeper::is_in_sequence(const StepQuestion& question) {
    const auto [last, is_new] = sequences_.try_emplace(question.connection, question.sequence);
    if (is_new) return true;
    if (question.sequence <= last->second) return false;
    last->second = question.sequence;
    return true;
}

Judgement Gatekeeper::judge(const StepQuestion& question,
                            bool in_sequence,
                            std::int64_t now_ns) const noexcept {
    Judgement judgement;
    judgement.health = health();
    if (!in_sequence) judgement.health.faults.add(gate::Reason::seq);
    judgement.query = gate::query_at_body(question.command, *map_);
    judgement.query.attested = attestation_.area();
    judgement.query.connection = question.connection;
    judgement.query.sequence = question.sequence;
    judgement.now_ns = now_ns;
    judgement.verdict = gate::decide(machine_, judgement.query, *map_, judgement.health, now_ns);
    return judgement;
}

Answer Gatekeeper::ask_step(const StepQuestion& question, std::int64_t now_ns) {
    fetch(now_ns);
    const bool in_sequence = is_in_sequence(question);
    Judgement judgement = judge(question, in_sequence, now_ns);
    // If the verdict allows the step but a newer snapshot has arrived, judges once more with that
    // snapshot.
    if (judgement.verdict.allows_step(now_ns) && reader_ && reader_->has_fresh()) {
        fetch(now_ns);
        judgement = judge(question, in_sequence, now_ns);
    }
    ++asked_;
    if (judgement.verdict.allows_step(now_ns)) ++allowed_;
    if (audit_) audit_(judgement, *map_);
    return {judgement.verdict, gate::text_of(judgement.verdict, judgement.query, machine_)};
}

Answer Gatekeeper::ask_goal(const GoalQuestion& question, std::int64_t now_ns) {
    fetch(now_ns);
    gate::GateHealth health = this->health();
    if (question.frame_id != "odom") health.faults.add(gate::Reason::frame_id);
    gate::Query here = gate::query_at_body(0, *map_);
    here.attested = attestation_.area();
    here.connection = question.connection;
    // make_query rejects invalid numbers. In that case the goal has no valid pose.
    const gate::Query there = gate::make_query(
        0, question.x_m, question.y_m, std::cos(question.yaw_rad), std::sin(question.yaw_rad));
    const gate::GoalPose goal{there.x_tenth_mm, there.y_tenth_mm, there.cos_yaw, there.sin_yaw};
    Answer answer{gate::judge_goal(machine_, here, goal, *map_, health, now_ns), {}};
    answer.text = gate::text_of(answer.verdict, there, machine_);
    return answer;
}

std::span<const std::uint8_t> Gatekeeper::movements() const noexcept {
    return std::span(movements_).first(movement_count_);
}

Prospect Gatekeeper::prospect_of(std::uint8_t command, std::int64_t now_ns) const noexcept {
    // Connection 0 belongs to no client. Uses the map of the last poll.
    Judgement judgement = judge({.connection = 0, .sequence = 0, .command = command}, true, now_ns);
    judgement.verdict.valid_until_ns = judgement.verdict.decided_ns;
    return {judgement.query, judgement.verdict};
}

std::string Gatekeeper::words_of(const Prospect& prospect) const {
    return gate::text_of(prospect.verdict, prospect.query, machine_);
}

GateReport Gatekeeper::report(std::int64_t now_ns) {
    GateReport report;
    report.health = health();
    report.why = report.health.faults.primary();
    if (report.why == gate::Reason::none) {
        if (report.health.state == gate::GateState::warmup)
            report.why = gate::Reason::warmup;
        else if (report.health.state != gate::GateState::ready)
            report.why = gate::Reason::not_ready;
    }
    report.attestation = attestation_.area().active;
    report.attested = attestation_.area();
    report.asked = asked_;
    report.allowed = allowed_;
    if (has_map_) {
        report.map_version = map_->version;
        report.frame_age_ns = now_ns - map_->frame_time_ns;
        report.pose_age_ns = now_ns - map_->pose_time_ns;
    }
    return report;
}

Status Gatekeeper::rearm(std::uint64_t /*connection*/, std::int64_t now_ns) {
    // The canaries take milliseconds. So run them only in a fault, not whenever a client asks.
    if (readiness_.state() == gate::GateState::fault && !canaries_->judge_all().passed)
        return Error{
            ErrorCode::usage,
            "the gate fails its self-test: its verdict on a known map is wrong, so it must "
            "not be used. Restart the gate; if that does not help, reinstall it"};
    if (!readiness_.rearm(now_ns))
        return Error{ErrorCode::usage,
                     "the gate was not re-armed: it has no fault, or its configuration is "
                     "invalid. Correct an invalid configuration and restart the gate"};
    attestation_.revoke();
    if (channel_state_ == ChannelState::forged) channel_state_ = ChannelState::open;
    if (reader_) {  // the map from before the fault is not used again
        reader_->keep_faults(0);
        reader_->want_restart();
        given_up_ = reader_->writer();
    }
    return {};
}

Status Gatekeeper::check_radius(double radius_m) const {
    const double most_m = machine_.limits.attestation_radius_tenth_mm * 1e-4;
    const std::int64_t least_tenth_mm = least_radius_tenth_mm();
    const bool is_number = radius_m > 0.0 && radius_m <= most_m;
    if (is_number && tenth_mm(radius_m) >= least_tenth_mm) return {};
    return refuse_attestation(
        fmt::format("the radius of {} m must be from {:.4f} m (the smallest circle around "
                    "base_link that contains both soles) to {} m (attestation_radius_m of the "
                    "machine file)",
                    radius_m,
                    static_cast<double>(least_tenth_mm) * 1e-4,
                    most_m));
}

std::int64_t Gatekeeper::least_radius_tenth_mm() const {
    const auto square = static_cast<double>(gate::least_attested_radius_sq(machine_));
    return static_cast<std::int64_t>(std::ceil(std::sqrt(square)));  // in range: root of an integer
}

Status Gatekeeper::attest(std::uint64_t /*connection*/, double radius_m, std::int64_t now_ns) {
    fetch(now_ns);
    if (!has_map_ || !gate::snapshot_faults(machine_, *map_, now_ns).empty())
        return refuse_attestation(
            "the gate has no map without faults; see the faults in /surefoot/health, and wait "
            "until perception is healthy");
    if (readiness_.state() == gate::GateState::fault)
        return refuse_attestation("the gate is in FAULT; re-arm it first");
    if (auto status = check_radius(radius_m); !status) return status;
    if (!attestation_.attest(machine_, *map_, tenth_mm(radius_m), now_ns))
        return refuse_attestation("the newest map is damaged; try again");
    return {};
}

Status Gatekeeper::attest_when_ready(double radius_m) {
    if (auto status = check_radius(radius_m); !status) return status;
    starters_word_m_ = radius_m;
    return {};
}

void Gatekeeper::note(const Act& act) {
    if (!audit_act_) return;
    if (act.outcome == ActOutcome::no_right && !refusals_.take(act.time_ns)) {
        ++refusals_left_out_;
        return;
    }
    Act whole = act;
    whole.left_out = std::exchange(refusals_left_out_, 0);
    audit_act_(whole);
}

void Gatekeeper::give_starters_word(std::int64_t now_ns) {
    if (starters_word_m_ == 0.0) return;
    const gate::GateState state = readiness_.state();
    if (state != gate::GateState::ready && state != gate::GateState::fault) return;
    const double radius_m = std::exchange(starters_word_m_, 0.0);
    if (attestation_.area().active) return;  // the operator's own attestation stays
    // If a fault causes a refusal, do not retry: the attestation was for the position at the start.
    // `report` shows whether the attestation is valid.
    const Status attested = attest(0, radius_m, now_ns);
    note(act_of(ActKind::attest, Role::operator_, 0, attested, now_ns, radius_m));
}

}  // namespace surefoot::gate_process
