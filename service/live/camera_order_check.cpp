// SPDX-License-Identifier: Apache-2.0
#include "service/live/camera_order_check.hpp"

#include <fmt/format.h>

#include "service/console/log.hpp"
#include "service/live/measured_pair.hpp"

namespace surefoot::app {

Status CameraOrderCheck::check(const pipeline::Pipeline& pipeline,
                               const FrameReport& report,
                               bool quiet) {
    const camera::RectifiedPair& pair = pipeline.pair();
    if (left_ == 0 || report.work != Work::full || pair.right.empty()) return {};
    const stereo::PairCheck check = check_rows(pair, pipeline.config().stereo.disparities);
    --left_;
    if (!check.enough() && left_ > 0) return {};
    left_ = 0;
    const std::string where = fmt::format("{}: frame {}: ", source_, report.index);
    const std::string rows = row_problem(check, true);
    if (!rows.empty() && !quiet) log_warning(where + rows);
    const Status status = refuse_swapped(check);
    return status ? Status{} : input_error(where + status.error().message);
}

}  // namespace surefoot::app
