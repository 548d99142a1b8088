// SPDX-License-Identifier: Apache-2.0
#include "server/wire/snapshot_channel.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <random>
#include <utility>

namespace surefoot::wire {
namespace {

constexpr std::uint64_t kMagic = 0x4c4e484354465253;  // "SRFTCHNL"
constexpr std::uint32_t kLayout = 2;
constexpr std::uint64_t kSlots = 3;
using Atomic = std::atomic<std::uint64_t>;
static_assert(Atomic::is_always_lock_free, "the other process would not see the lock");
constexpr std::size_t kWords = sizeof(grid::MapSnapshot) / sizeof(std::uint64_t);
static_assert(sizeof(grid::MapSnapshot) % sizeof(std::uint64_t) == 0);

struct Slot {
    alignas(64) Atomic sequence;  ///< odd while the words change
    alignas(64) std::array<Atomic, kWords> words;
};

}  // namespace

/// The snapshot travels as words that are each read and written whole, so that reading while the
/// other side writes is defined; the sequence then tells that what was read belongs together
/// (Boehm, Can seqlocks get along with programming language memory models?, MSPC 2012).
struct ChannelMemory {
    std::uint64_t magic;
    std::uint32_t layout;
    std::uint32_t snapshot_bytes;
    Atomic writer;          ///< number of the present writer, 0 while it begins
    Atomic published;       ///< snapshots so far; the newest lies in slot published % 3
    Atomic restart_wanted;  ///< number of the writer that shall begin anew
    Atomic faults;          ///< of the gate, until an operator re-arms it; 0 = none
    std::array<Slot, kSlots> slots;
};

namespace {

Error failure(const std::string& path, const std::string& what) {
    return {ErrorCode::input, "snapshot channel " + path + ": " + what};
}

std::string system_words() {
    return std::strerror(errno);  // NOLINT(concurrency-mt-unsafe): before any thread
}

/// Never 0, and hardly ever the same twice.
std::uint64_t new_number() {
    std::random_device device;
    const std::uint64_t high = device();
    return (high << 32U | device()) | 1U;
}

void store_words(Slot& slot, const grid::MapSnapshot& map) noexcept {
    const auto* bytes = reinterpret_cast<const unsigned char*>(&map);
    for (std::size_t i = 0; i < kWords; ++i) {
        std::uint64_t word = 0;
        std::memcpy(&word, bytes + i * sizeof(word), sizeof(word));
        slot.words[i].store(word, std::memory_order_relaxed);
    }
}

void load_words(const Slot& slot, grid::MapSnapshot& map) noexcept {
    auto* bytes = reinterpret_cast<unsigned char*>(&map);
    for (std::size_t i = 0; i < kWords; ++i) {
        const std::uint64_t word = slot.words[i].load(std::memory_order_relaxed);
        std::memcpy(bytes + i * sizeof(word), &word, sizeof(word));
    }
}

}  // namespace

ChannelMapping::ChannelMapping(ChannelMapping&& other) noexcept
    : memory_(std::exchange(other.memory_, nullptr)) {}

ChannelMapping& ChannelMapping::operator=(ChannelMapping&& other) noexcept {
    std::swap(memory_, other.memory_);
    return *this;
}

ChannelMapping::~ChannelMapping() {
    if (memory_ != nullptr) ::munmap(memory_, sizeof(ChannelMemory));
}

Result<ChannelMapping> ChannelMapping::open(const std::string& path, bool create) {
    const int flags = O_RDWR | O_CLOEXEC | O_NOFOLLOW | (create ? O_CREAT : 0);
    const int file = ::open(path.c_str(), flags, 0600);
    if (file < 0) return failure(path, "cannot be opened: " + system_words());
    struct stat info {};
    const auto wanted = static_cast<off_t>(sizeof(ChannelMemory));
    const bool sized = ::fstat(file, &info) == 0 && S_ISREG(info.st_mode) &&
                       (info.st_size == wanted || (create && ::ftruncate(file, wanted) == 0));
    void* memory =
        sized ? ::mmap(nullptr, sizeof(ChannelMemory), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0)
              : MAP_FAILED;
    const std::string why = sized ? system_words() : "it is no channel of this version";
    ::close(file);
    if (memory == MAP_FAILED) return failure(path, "cannot be used: " + why);
    ChannelMapping mapping;
    mapping.memory_ = static_cast<ChannelMemory*>(memory);
    const ChannelMemory& m = *mapping.memory_;
    if (!create && !(m.magic == kMagic && m.layout == kLayout &&
                     m.snapshot_bytes == sizeof(grid::MapSnapshot)))
        return failure(path, "it is no channel of this version; start both programs anew");
    return mapping;
}

Result<SnapshotWriter> SnapshotWriter::create(const std::string& path) {
    auto mapping = ChannelMapping::open(path, true);
    if (!mapping) return mapping.error();
    ChannelMemory& m = *mapping->memory();
    m.magic = kMagic;
    m.layout = kLayout;
    m.snapshot_bytes = sizeof(grid::MapSnapshot);
    m.faults.store(0, std::memory_order_seq_cst);
    SnapshotWriter writer(std::move(*mapping));
    writer.begin_anew();
    return writer;
}

void SnapshotWriter::begin_anew() noexcept {
    ChannelMemory& m = *mapping_.memory();
    m.writer.store(0, std::memory_order_seq_cst);  // nobody believes the slots meanwhile
    published_ = 0;
    m.published.store(0, std::memory_order_seq_cst);
    for (Slot& slot : m.slots) {  // one who died while writing left an odd sequence
        const std::uint64_t sequence = slot.sequence.load(std::memory_order_relaxed);
        slot.sequence.store((sequence | 1U) + 1U, std::memory_order_seq_cst);
    }
    m.writer.store(new_number(), std::memory_order_seq_cst);
}

void SnapshotWriter::publish(const grid::MapSnapshot& map) noexcept {
    ChannelMemory& m = *mapping_.memory();
    Slot& slot = m.slots[(published_ + 1) % kSlots];
    const std::uint64_t sequence = slot.sequence.load(std::memory_order_relaxed);
    slot.sequence.store(sequence + 1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    store_words(slot, map);
    slot.sequence.store(sequence + 2, std::memory_order_release);
    m.published.store(++published_, std::memory_order_release);
}

bool SnapshotWriter::restart_wanted() const noexcept {
    const ChannelMemory& m = *mapping_.memory();
    return m.restart_wanted.load(std::memory_order_acquire) ==
           m.writer.load(std::memory_order_relaxed);
}

Result<SnapshotReader> SnapshotReader::open(const std::string& path) {
    auto mapping = ChannelMapping::open(path, false);
    if (!mapping) return mapping.error();
    return SnapshotReader(std::move(*mapping));
}

bool SnapshotReader::has_fresh() const noexcept {
    const ChannelMemory& m = *mapping_.memory();
    return m.published.load(std::memory_order_acquire) != seen_ ||
           m.writer.load(std::memory_order_acquire) != writer_;
}

SnapshotReader::Read SnapshotReader::read(grid::MapSnapshot& out) noexcept {
    const ChannelMemory& m = *mapping_.memory();
    for (int attempt = 0; attempt < 3; ++attempt) {
        const std::uint64_t writer = m.writer.load(std::memory_order_acquire);
        const std::uint64_t published = m.published.load(std::memory_order_acquire);
        if (writer != writer_) {
            writer_ = writer;
            seen_ = 0;
        }
        if (writer == 0 || published == 0) return Read::nothing;
        if (published == seen_) return Read::same;
        const Slot& slot = m.slots[published % kSlots];
        const std::uint64_t before = slot.sequence.load(std::memory_order_acquire);
        if (before % 2 != 0) continue;
        load_words(slot, out);
        std::atomic_thread_fence(std::memory_order_acquire);
        const bool whole = slot.sequence.load(std::memory_order_relaxed) == before &&
                           m.writer.load(std::memory_order_relaxed) == writer;
        if (!whole) continue;
        seen_ = published;
        return Read::fresh;
    }
    return Read::torn;
}

void SnapshotReader::keep_faults(std::uint64_t bits) noexcept {
    mapping_.memory()->faults.store(bits, std::memory_order_release);
}

std::uint64_t SnapshotReader::kept_faults() const noexcept {
    return mapping_.memory()->faults.load(std::memory_order_acquire);
}

void SnapshotReader::want_restart() noexcept {
    ChannelMemory& m = *mapping_.memory();
    m.restart_wanted.store(m.writer.load(std::memory_order_acquire), std::memory_order_release);
}

}  // namespace surefoot::wire
