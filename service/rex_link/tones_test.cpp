// SPDX-License-Identifier: Apache-2.0
// Measures the notes in the audio files of tools/tones: their number, length and pitch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "service/rex_link/rex_link.hpp"

namespace surefoot::rex_link {
namespace {

constexpr int kRate_hz = 16000;
constexpr std::size_t kHeader_bytes = 44;

struct Note {
    double duration_s = 0.0;
    double pitch_hz = 0.0;        ///< strongest component between 100 and 4000 Hz
    double overtone_share = 0.0;  ///< amplitude one octave above, relative to the pitch's
};

std::string read_tone(Tone tone) {
    std::ifstream file(
        std::string(SUREFOOT_SOURCE_DIR) + "/service/rex_link/tones/" + to_string(tone) + ".wav",
        std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

template <typename T>
T number_at(const std::string& bytes, std::size_t at) {
    T value{};
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}

std::vector<double> samples_of(const std::string& wav) {
    std::vector<double> samples;
    for (std::size_t at = kHeader_bytes; at + 1 < wav.size(); at += 2)
        samples.push_back(number_at<std::int16_t>(wav, at) / 32768.0);
    return samples;
}

/// Amplitude of the stretch's Fourier component at a frequency.
double amplitude(const std::vector<double>& stretch, double frequency_hz) {
    double cosine = 0.0, sine = 0.0;
    for (std::size_t i = 0; i < stretch.size(); ++i) {
        const double angle = 2.0 * M_PI * frequency_hz * static_cast<double>(i) / kRate_hz;
        cosine += stretch[i] * std::cos(angle);
        sine += stretch[i] * std::sin(angle);
    }
    return 2.0 * std::hypot(cosine, sine) / static_cast<double>(stretch.size());
}

Note note_of(const std::vector<double>& stretch) {
    Note note;
    note.duration_s = static_cast<double>(stretch.size()) / kRate_hz;
    double strongest = 0.0;
    for (double frequency_hz = 100.0; frequency_hz < 4000.0; frequency_hz += 5.0) {
        const double here = amplitude(stretch, frequency_hz);
        if (here > strongest) {
            strongest = here;
            note.pitch_hz = frequency_hz;
        }
    }
    note.overtone_share = amplitude(stretch, 2.0 * note.pitch_hz) / strongest;
    return note;
}

/// The notes; a silence of at least 10 ms separates them.
std::vector<Note> notes_of(const std::vector<double>& samples) {
    constexpr std::size_t kWindow = kRate_hz / 100;
    std::vector<Note> notes;
    std::vector<double> stretch;
    for (std::size_t begin = 0; begin < samples.size(); begin += kWindow) {
        const auto first = samples.begin() + static_cast<std::ptrdiff_t>(begin);
        const auto last = begin + kWindow < samples.size()
                              ? first + static_cast<std::ptrdiff_t>(kWindow)
                              : samples.end();
        if (std::any_of(first, last, [](double value) { return std::abs(value) > 0.01; })) {
            stretch.insert(stretch.end(), first, last);
        } else if (!stretch.empty()) {
            notes.push_back(note_of(stretch));
            stretch.clear();
        }
    }
    if (!stretch.empty()) notes.push_back(note_of(stretch));
    return notes;
}

std::vector<Note> notes_of(Tone tone) {
    return notes_of(samples_of(read_tone(tone)));
}

TEST(Tones, AreShortMonoFilesOf16Bit) {
    for (int i = 0; i < kToneCount; ++i) {
        const std::string wav = read_tone(static_cast<Tone>(i));
        ASSERT_GT(wav.size(), kHeader_bytes) << i;
        EXPECT_EQ(wav.substr(0, 4) + wav.substr(8, 8), "RIFFWAVEfmt ");
        EXPECT_EQ(number_at<std::uint16_t>(wav, 20), 1) << "PCM";
        EXPECT_EQ(number_at<std::uint16_t>(wav, 22), 1) << "channels";
        EXPECT_EQ(number_at<std::uint32_t>(wav, 24), std::uint32_t{kRate_hz});
        EXPECT_EQ(number_at<std::uint16_t>(wav, 34), 16) << "bits";
        EXPECT_EQ(number_at<std::uint32_t>(wav, 4), wav.size() - 8);
        EXPECT_EQ(number_at<std::uint32_t>(wav, 40), wav.size() - kHeader_bytes);
        EXPECT_LT(wav.size() - kHeader_bytes, 2U * kRate_hz) << "a second";
    }
}

TEST(Tones, AreLoudButNotCut) {
    for (int i = 0; i < kToneCount; ++i) {
        double peak = 0.0;
        for (const double sample : samples_of(read_tone(static_cast<Tone>(i))))
            peak = std::max(peak, std::abs(sample));
        EXPECT_GT(peak, 0.5) << i;
        EXPECT_LT(peak, 0.95) << i;
    }
}

TEST(Tones, AcknowledgementIsOneHighNote) {
    const auto notes = notes_of(Tone::acknowledge);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_NEAR(notes[0].pitch_hz, 880.0, 10.0);
    EXPECT_NEAR(notes[0].duration_s, 0.14, 0.02);
}

TEST(Tones, NotTraversableIsTwoFallingNotes) {
    const auto notes = notes_of(Tone::not_traversable);
    ASSERT_EQ(notes.size(), 2U);
    EXPECT_LT(notes[1].pitch_hz, 0.75 * notes[0].pitch_hz);
    EXPECT_NEAR(notes[0].duration_s, notes[1].duration_s, 0.02);
}

TEST(Tones, CannotJudgeIsThreeEqualLowBeeps) {
    const auto notes = notes_of(Tone::cannot_judge);
    ASSERT_EQ(notes.size(), 3U);
    for (const Note& note : notes) {
        EXPECT_NEAR(note.pitch_hz, 220.0, 10.0);
        EXPECT_NEAR(note.duration_s, notes[0].duration_s, 0.02);
    }
}

TEST(Tones, NoTwoShareAPitchAndNoBandIsNeeded) {
    std::vector<double> pitches_hz;
    for (int i = 0; i < kToneCount; ++i) {
        double mean_hz = 0.0;
        const auto notes = notes_of(static_cast<Tone>(i));
        for (const Note& note : notes) {
            mean_hz += note.pitch_hz / static_cast<double>(notes.size());
            EXPECT_GT(note.overtone_share, 0.25) << "an octave above " << note.pitch_hz << " Hz";
        }
        pitches_hz.push_back(mean_hz);
    }
    std::sort(pitches_hz.begin(), pitches_hz.end());
    for (std::size_t i = 1; i < pitches_hz.size(); ++i)
        EXPECT_GT(pitches_hz[i], 1.5 * pitches_hz[i - 1]) << "less than a fifth apart";
}

}  // namespace
}  // namespace surefoot::rex_link
