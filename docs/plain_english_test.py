# SPDX-License-Identifier: BSD-3-Clause
"""Checks docs/plain_english.py on pages whose sentences are known."""
import unittest

import plain_english

PAGE = """# A heading of many words that is no sentence at all

Two short sentences. The second has `lidarena run x` and [a link](a/very/long/address.md).

| a table | is no sentence |
|---|---|

    indented --code is no sentence

```yaml
a: fence   # neither
```

- W. Xu et al. wrote it, e.g. in 2022
- an item of
  two lines

![a picture is none](images/x.png)
"""
LONG = " ".join(["word"] * 26) + "."


class PlainEnglish(unittest.TestCase):
    def test_sentences_are_those_of_paragraphs_and_items(self):
        self.assertEqual(plain_english.sentences(PAGE), [
            "Two short sentences.", "The second has `lidarena_run_x` and a link.",
            "W Xu et al wrote it, e.g in 2022", "an item of two lines"])

    def test_code_of_an_item_s_second_paragraph_and_generated_tables_are_no_sentences(self):
        text = "<!-- table test drift indoor -->\n\ntext 1.\n\n<!-- end -->\n\nIt is <!-- = a -->1.2<!-- end --> cm."
        self.assertEqual(plain_english.sentences(text), ["It is 1.2 cm."])

    def test_a_number_with_a_decimal_point_ends_no_sentence(self):
        self.assertEqual(plain_english.sentences("It is 3.5 m long. `x` is 2."),
                         ["It is 3.5 m long.", "`x` is 2."])

    def test_25_words_are_allowed_and_26_are_a_fault(self):
        self.assertEqual(list(plain_english.faults(LONG[5:])), [])
        self.assertEqual([fault for _, fault in plain_english.faults(LONG)], ["26 words"])

    def test_a_stilted_word_is_a_fault_with_what_to_write(self):
        (_, fault), = plain_english.faults("The map stands in a file.")
        self.assertEqual(fault, '"stands": write is, are')
        self.assertEqual(list(plain_english.faults("Understand the standard, and `stands`.")), [])

    def test_an_exception_covers_its_sentence_alone_and_must_be_needed(self):
        allowed = plain_english.exceptions("# comment\na.md | word word | quoted from a paper\n")
        self.assertEqual(plain_english.check({"a.md": LONG}, allowed), [])
        other = plain_english.check({"b.md": LONG, "a.md": "Short."}, allowed)
        self.assertEqual(len(other), 2)
        self.assertTrue(other[0].startswith("b.md: 26 words"))
        self.assertIn("no sentence of a.md needs", other[1])

    def test_an_exception_without_a_reason_is_refused(self):
        with self.assertRaises(ValueError):
            plain_english.exceptions("a.md | word word\n")

    def test_words_are_counted(self):
        self.assertEqual(plain_english.counted("a.md", "One two. Three - four five six.").split()[1:8],
                         ["6", "words", "2", "sentences", "3.0", "words", "a"])


if __name__ == "__main__":
    unittest.main()
