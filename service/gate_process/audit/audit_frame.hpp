// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "service/gate_process/audit/audit_record.hpp"
#include "service/gate_process/sockets/acts.hpp"

/// A log is a row of frames, each with the hash of the one before (docs/reference/audit_format.md):
///
///     magic+version  kind  encoding  0  stored  plain  sequence  previous  check | payload | hash
///     4              1     1         2  4       4      8         8         4     | stored  | 8
namespace surefoot::gate_process {

enum class FrameKind : std::uint8_t { file = 1, verdict = 2, gap = 3, act = 4 };
enum class FrameEncoding : std::uint8_t { plain = 0, zstd = 1 };

struct FrameHeader {
    FrameKind kind = FrameKind::file;
    FrameEncoding encoding = FrameEncoding::plain;
    std::uint32_t stored_bytes = 0;         ///< of the payload in the file
    std::uint32_t plain_bytes = 0;          ///< of the payload unpacked
    std::uint64_t sequence = 0;             ///< grows by one with every frame of a run
    std::uint64_t previous_hash = 0;        ///< of the frame before; 0 = the first of a run
    std::uint32_t version = kFrameVersion;  ///< of the format, as the frame was written
};

inline constexpr std::uint32_t kFrameMagic = 0x00414653;  // "SFA", the last byte is the version
inline constexpr std::uint32_t kOldestFrameVersion = 2;   ///< that is read; it has no acts
inline constexpr std::size_t kFrameHeaderBytes = 36;
inline constexpr std::size_t kFrameHashBytes = 8;
/// No payload is longer, packed or not.
inline constexpr std::size_t kMaxPayloadBytes = kMaxRecordBytes + 65536;

/// Appends a whole frame; returns its hash. `stored` is the payload as `header.encoding` has it.
std::uint64_t append_frame(std::string& out, const FrameHeader& header, std::string_view stored);

enum class HeaderState : std::uint8_t { sound, no_frame, other_version, damaged };
/// The first kFrameHeaderBytes of a frame.
[[nodiscard]] HeaderState parse_frame_header(std::string_view bytes, FrameHeader& header) noexcept;

/// What a file begins with.
struct FileHead {
    std::uint64_t run_id = 0;  ///< of one gate process
    std::uint64_t number = 0;  ///< of the file in its folder
    std::uint64_t machine_hash = 0;
    Machine machine;
};
[[nodiscard]] std::string format_file_head(const FileHead& head);
[[nodiscard]] Status parse_file_head(std::string_view bytes, FileHead& head);

/// Verdicts that found no room in memory while the disk took nothing.
struct AuditGap {
    std::uint64_t verdicts = 0;
    std::int64_t first_ns = 0;  ///< when the first and the last of them were decided
    std::int64_t last_ns = 0;
};
[[nodiscard]] std::string format_gap(const AuditGap& gap);
[[nodiscard]] Status parse_gap(std::string_view bytes, AuditGap& gap);

/// Bytes of an act, whose text is cut at kMaxActText_bytes.
[[nodiscard]] std::size_t act_bytes(const Act& act) noexcept;
/// Writes that many bytes. Allocates nothing.
void write_act(const Act& act, char* out) noexcept;
[[nodiscard]] Status parse_act(std::string_view bytes, Act& act);

/// "audit-RUN-NUMBER.log", with the run in 16 hexadecimal digits and the number in 8 decimal ones.
[[nodiscard]] std::string audit_file_name(std::uint64_t run_id, std::uint64_t number);
/// The number of such a name; false for every other name.
[[nodiscard]] bool parse_audit_file_name(std::string_view name, std::uint64_t& number) noexcept;

}  // namespace surefoot::gate_process
