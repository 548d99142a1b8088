// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/slots.hpp"

#include <algorithm>
#include <tuple>

namespace surefoot::gate_process {
namespace {

constexpr std::int64_t kForgetHalf_ns = 1'000'000'000;
/// Cost above which a client counts as too expensive. A question costs 0.15 ms, so the decayed cost
/// of a rider that asks 15 times a second is at most 4.5 ms.
constexpr std::int64_t kHeavy_ns = 5'000'000;

/// After a minute, costs have decayed completely.
std::int64_t remaining(std::int64_t cost_ns, std::int64_t age_ns) noexcept {
    constexpr std::int64_t kMostHalves = 62;
    return cost_ns >> std::clamp<std::int64_t>(age_ns / kForgetHalf_ns, 0, kMostHalves);
}

/// The order in which clients of low rank are closed.
enum Order : int { order_silent, order_idle, order_heavy, order_listener, order_useful };

}  // namespace

const char* SlotLimits::problem() const noexcept {
    if (max_clients == 0 || max_handshakes == 0 || per_peer == 0)
        return "max_clients, max_handshakes and per_peer must be above 0";
    if (reserved >= max_clients) return "reserved must be below max_clients";
    if (useful_ns <= 0) return "useful_ns must be above 0";
    return nullptr;
}

std::optional<Slots::Id> Slots::arrive(Id id, std::string_view peer, std::int64_t now_ns) {
    const auto ended =
        handshakes() >= limits_.max_handshakes ? fullest_door() : std::optional<Id>{};
    Held held;
    held.peer = peer;
    held.since_ns = now_ns;
    held_.insert_or_assign(id, std::move(held));
    return ended;
}

/// Ids increase, so the first match of a peer is its oldest.
std::optional<Slots::Id> Slots::fullest_door() const {
    struct Door {
        std::size_t count = 0;
        Id oldest = 0;
    };
    std::map<std::string_view, Door> doors;
    for (const auto& [id, held] : held_) {
        if (held.is_client) continue;
        Door& door = doors[held.peer];
        if (door.count++ == 0) door.oldest = id;
    }
    const auto fullest = std::max_element(doors.begin(), doors.end(), [](auto& a, auto& b) {
        return a.second.count < b.second.count;
    });
    if (fullest == doors.end()) return std::nullopt;
    return fullest->second.oldest;
}

Slots::Entry Slots::enter(Id id, Rank rank, std::int64_t now_ns) {
    const auto found = held_.find(id);
    if (found == held_.end() || found->second.is_client) return {};
    Held& held = found->second;
    Entry entry;
    if (rank == Rank::low && !held.peer.empty() && low_clients_of(held.peer) >= limits_.per_peer) {
        entry.peer_is_full = true;
        return entry;
    }
    const std::size_t low =
        static_cast<std::size_t>(std::count_if(held_.begin(), held_.end(), [](const auto& h) {
            return h.second.is_client && h.second.rank == Rank::low;
        }));
    const bool low_is_full = rank == Rank::low && low >= limits_.max_clients - limits_.reserved;
    if (low_is_full || clients() >= limits_.max_clients) {
        entry.ended = least_useful(rank, now_ns);
        if (!entry.ended) return entry;
    }
    entry.granted = true;
    held.is_client = true;
    held.rank = rank;
    held.since_ns = now_ns;
    return entry;
}

void Slots::promote(Id id) noexcept {
    if (const auto found = held_.find(id); found != held_.end()) found->second.rank = Rank::high;
}

void Slots::served(Id id, std::int64_t now_ns, std::int64_t cost_ns) noexcept {
    const auto found = held_.find(id);
    if (found == held_.end()) return;
    Held& held = found->second;
    const std::int64_t age_ns = now_ns - held.cost_at_ns;
    held.cost_ns = cost_ns + remaining(held.cost_ns, age_ns);
    if (age_ns >= kForgetHalf_ns) held.cost_at_ns = now_ns;  // costs within 1 s add up
    held.was_served = true;
    held.since_ns = now_ns;
}

void Slots::listens(Id id, bool listens) noexcept {
    if (const auto found = held_.find(id); found != held_.end()) found->second.listens = listens;
}

std::int64_t Slots::burden_ns(Id id, std::int64_t now_ns) const noexcept {
    const auto found = held_.find(id);
    if (found == held_.end()) return 0;
    return remaining(found->second.cost_ns, now_ns - found->second.cost_at_ns);
}

std::size_t Slots::clients() const noexcept {
    return static_cast<std::size_t>(std::count_if(
        held_.begin(), held_.end(), [](const auto& held) { return held.second.is_client; }));
}

bool Slots::is_high(Id id) const noexcept {
    const auto found = held_.find(id);
    return found != held_.end() && found->second.rank == Rank::high;
}

std::size_t Slots::low_clients_of(std::string_view peer) const noexcept {
    return static_cast<std::size_t>(
        std::count_if(held_.begin(), held_.end(), [peer](const auto& held) {
            return held.second.is_client && held.second.rank == Rank::low &&
                   held.second.peer == peer;
        }));
}

int Slots::order_of(const Held& held, std::int64_t now_ns) const noexcept {
    const bool idle = !held.was_served || now_ns - held.since_ns >= limits_.useful_ns;
    if (!held.was_served && !held.listens) return order_silent;
    if (idle && !held.listens) return order_idle;
    if (remaining(held.cost_ns, now_ns - held.cost_at_ns) > kHeavy_ns) return order_heavy;
    return idle ? order_listener : order_useful;
}

std::optional<Slots::Id> Slots::least_useful(Rank newcomer, std::int64_t now_ns) const {
    std::optional<Id> found;
    std::tuple<int, std::int64_t, std::int64_t> least{};
    for (const auto& [id, held] : held_) {
        if (!held.is_client || held.rank == Rank::high) continue;
        const int order = order_of(held, now_ns);
        if (order == order_useful && newcomer == Rank::low) continue;
        const std::int64_t cost_ns =
            order == order_heavy ? remaining(held.cost_ns, now_ns - held.cost_at_ns) : 0;
        const std::tuple key{order, -cost_ns, held.since_ns};
        if (!found || key < least) {
            found = id;
            least = key;
        }
    }
    return found;
}

}  // namespace surefoot::gate_process
