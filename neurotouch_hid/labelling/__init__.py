"""Labels recordings by hand: the recogniser proposes, a person looks, corrects and confirms.

recording ─▶ look through ─▶ proposals ─▶ sheet ─▶ NAME.labels.csv
                                 ▲          ▲
                               doubts     person, at the page
"""
