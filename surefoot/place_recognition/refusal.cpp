// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/refusal.hpp"

namespace surefoot::place_recognition {

const char* to_string(Refusal refusal) noexcept {
    switch (refusal) {
        case Refusal::none: return "none";
        case Refusal::few_features: return "few_features";
        case Refusal::no_candidate: return "no_candidate";
        case Refusal::few_matches: return "few_matches";
        case Refusal::few_inliers: return "few_inliers";
        case Refusal::poor_spread: return "poor_spread";
        case Refusal::imprecise: return "imprecise";
        case Refusal::tilted: return "tilted";
        case Refusal::contradicted: return "contradicted";
        case Refusal::floor_only: return "floor_only";
        case Refusal::ambiguous: return "ambiguous";
        case Refusal::unconfirmed: return "unconfirmed";
        case Refusal::inconsistent: return "inconsistent";
    }
    return "unknown";
}

}  // namespace surefoot::place_recognition
