// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::rex_link {

/// Bytes that the proxy delivers, the time of the delivery, and the changes to the bytes.
struct Delivery {
    std::string bytes;
    std::int64_t delay_ns = 0;
    bool truncated = false;
    bool altered = false;  ///< some bytes were changed
};

/// Loses, duplicates, delays, reorders, truncates and alters texts, each with its own probability.
class UnfaithfulProxy {
  public:
    /// A faithful proxy delivers every text once, unchanged, within 2 ms.
    UnfaithfulProxy(Rng rng, bool faithful) : rng_(rng) {
        constexpr double kChances[] = {0.0, 0.0, 0.02, 0.1, 0.3};
        for (double& chance : chances_) chance = faithful ? 0.0 : kChances[rng_.below(5)];
    }

    [[nodiscard]] std::vector<Delivery> pass(const std::string& bytes) {
        std::vector<Delivery> deliveries;
        if (!happens(kLose)) deliveries.push_back(deliver(bytes));
        while (happens(kDouble)) deliveries.push_back(deliver(bytes));
        return deliveries;
    }
    /// True if an old text should be replayed now.
    [[nodiscard]] bool replays() { return happens(kReplay); }
    [[nodiscard]] bool breaks() { return happens(kBreak); }

  private:
    enum Chance { kLose, kDouble, kDelay, kTruncate, kAlter, kReplay, kBreak, kCount };

    bool happens(Chance chance) { return rng_.uniform() < chances_[chance]; }

    Delivery deliver(const std::string& bytes) {
        constexpr double kUsual_ns = 2e6, kLong_ns = 4e8;
        Delivery delivery{bytes};
        delivery.delay_ns =
            static_cast<std::int64_t>(rng_.uniform(0.0, happens(kDelay) ? kLong_ns : kUsual_ns));
        if (happens(kTruncate)) {
            delivery.bytes.resize(rng_.below(bytes.size()));
            delivery.truncated = true;
        } else if (happens(kAlter)) {
            for (std::uint64_t i = 1 + rng_.below(3); i > 0; --i) alter(delivery);
        }
        return delivery;
    }

    /// Changes the value of one byte. Never changes the digits of the validity and of the
    /// connection. No other part of an answer repeats these two values, so only TCP's checksum
    /// protects them.
    void alter(Delivery& delivery) {
        const std::size_t at = rng_.below(delivery.bytes.size());
        for (const char* name : {"\"valid_for_ms\":", "\"connection\":"}) {
            const std::size_t begin = delivery.bytes.find(name);
            const std::size_t end = delivery.bytes.find(',', begin);
            if (begin != std::string::npos && at >= begin && at < end) return;
        }
        const auto change = static_cast<char>(1 + rng_.below(255));
        delivery.bytes[at] = static_cast<char>(delivery.bytes[at] ^ change);
        delivery.altered = true;
    }

    Rng rng_;
    std::array<double, kCount> chances_{};
};

}  // namespace surefoot::rex_link
