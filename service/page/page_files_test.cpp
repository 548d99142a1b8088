// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_files.hpp"

#include <gtest/gtest.h>

namespace surefoot::page {
namespace {

TEST(PageFiles, TheFirstPageIsThereAndNothingBesideTheFiles) {
    const PageFile* const first = find_page_file("/");
    ASSERT_NE(first, nullptr);
    EXPECT_EQ(first, find_page_file("/index.html"));
    EXPECT_EQ(first->gzip.substr(0, 2), "\x1f\x8b") << "gzip";
    EXPECT_GT(first->gzip.size(), 100U);
    for (const PageFile& file : page_files()) {
        EXPECT_EQ(find_page_file(file.path), &file);
        EXPECT_EQ(file.gzip.substr(0, 2), "\x1f\x8b") << file.path;
    }
    for (const char* path : {"", "index.html", "/index.html/", "/../index.html", "/INDEX.HTML"})
        EXPECT_EQ(find_page_file(path), nullptr) << path;
}

TEST(PageFiles, AreSmallEnoughForTheFirstSecond) {
    std::size_t bytes = 0;
    for (const PageFile& file : page_files()) bytes += file.gzip.size();
    EXPECT_LE(bytes, 1'000'000U);
}

TEST(PageFiles, TypesGoByTheEndOfTheName) {
    EXPECT_EQ(content_type_of("/index.html"), "text/html; charset=utf-8");
    EXPECT_EQ(content_type_of("/assets/a-1.js"), "text/javascript; charset=utf-8");
    EXPECT_EQ(content_type_of("/assets/a.css"), "text/css; charset=utf-8");
    EXPECT_EQ(content_type_of("/icon.svg"), "image/svg+xml");
    EXPECT_EQ(content_type_of("/js"), "application/octet-stream");
}

}  // namespace
}  // namespace surefoot::page
